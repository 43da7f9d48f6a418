// What a board's flash holds once it is programmed: the image, the same for all boards of a type, and the one
// board's configuration block in its own page.
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

/// Ascending, without overlaps; what is between parts stays erased.
using FlashContents = std::vector<FlashPart>;

/// The image alone, from the first byte of flash to the image's last, 0xFF between its
/// segments: the file that `objcopy -O binary` makes, if no two segments have a gap between. The image must
/// have passed `faults_of`.
[[nodiscard]] std::vector<std::uint8_t> binary(const ElfImage& image, const rig::BoardHardware& board);

/// The image and, in its page, the block; each part's end is filled with 0xFF up to the flash's own unit of 8
/// bytes. The image must have passed `faults_of`.
[[nodiscard]] FlashContents merge(const ElfImage& image, const NodeConfig& config,
                                  const rig::BoardHardware& board);

/// In Intel HEX: records of 16 bytes, line ends "\n". Intel, "Hexadecimal Object File Format Specification".
[[nodiscard]] std::string intel_hex(const FlashContents& contents);

}  // namespace octoskin::image
