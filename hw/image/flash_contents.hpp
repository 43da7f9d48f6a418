// Contents of a board's flash: the image, the same for all boards of a type, and the board's configuration
// block in its own page.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/config/node_config.hpp"
#include "hw/image/elf_image.hpp"
#include "hw/rigfile/board_hardware.hpp"

namespace octoskin::image {

struct FlashPart {
    std::uint32_t address = 0;
    std::vector<std::uint8_t> bytes;
    friend bool operator==(const FlashPart&, const FlashPart&) = default;
};

/// Ascending, without overlaps; the flash between the parts stays erased.
using FlashContents = std::vector<FlashPart>;

/// The image alone, from the first byte of flash to the last byte of the image, with 0xFF between its
/// segments. Equal to the output of `objcopy -O binary` if there is no gap between the segments.
/// Precondition: the image has passed `faults_of`.
[[nodiscard]] std::vector<std::uint8_t> binary(const ElfImage& image, const rig::BoardHardware& board);

/// The image, and the block in its page. Each part is padded with 0xFF to the flash's unit of 8 bytes.
/// Precondition: the image has passed `faults_of`.
[[nodiscard]] FlashContents merge(const ElfImage& image, const NodeConfig& config,
                                  const rig::BoardHardware& board);

/// `contents` as Intel HEX: records of 16 bytes, line ends "\n". Intel, "Hexadecimal Object File Format
/// Specification".
[[nodiscard]] std::string intel_hex(const FlashContents& contents);

}  // namespace octoskin::image
