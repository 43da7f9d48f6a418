// The hardware of a type of board: memory, clocks, pins. The limits for the check of a rig are in rig.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

struct MemoryRange {
    std::uint32_t address = 0;
    std::uint32_t size_bytes = 0;

    /// One past the last address.
    [[nodiscard]] constexpr std::uint64_t end() const { return std::uint64_t{address} + size_bytes; }
    [[nodiscard]] constexpr bool contains(std::uint64_t first, std::uint64_t bytes) const {
        return first >= address && first <= end() && bytes <= end() - first;
    }
};

struct BoardPin {
    char port = 'A';
    std::uint8_t number = 0;
    friend constexpr auto operator<=>(const BoardPin&, const BoardPin&) = default;
};

struct BoardSignal {
    std::string signal;  ///< octoskin's name
    BoardPin pin;
    std::string connector;  ///< "CN7-17"
    std::string function;   ///< the datasheet's name of the pin's role; "input" or "output" for a plain one
    std::optional<std::uint8_t> alternate;  ///< number of the alternate function, 0..15
    bool is_open_drain = false;             ///< for an output
    bool is_pulled_up = false;              ///< for an input, by the chip's own resistor
};

struct BoardHardware {
    std::string name;
    std::string openocd_board;    ///< a script that OpenOCD ships
    std::uint32_t device_id = 0;  ///< of the chip, as read by its debug port
    MemoryRange flash;
    MemoryRange configuration_page;  ///< within flash, up to its end
    MemoryRange ram;
    std::uint32_t vector_count = 0;  ///< initial stack pointer included
    std::uint32_t crystal_hz = 0;
    std::uint32_t core_hz = 0;
    std::uint32_t can_hz = 0;
    std::uint32_t i2c_hz_max = 0;
    std::uint32_t serial_baud = 0;
    std::vector<BoardSignal> signals;  ///< in the order of the file; no pin and no signal twice
};

/// "PA15".
[[nodiscard]] std::string text(const BoardPin& pin);

/// Reads `hw/boards/<name>.hardware.yaml`. Refused, with file, line and key: unknown keys, values out of
/// range, memory that does not nest, a pin or a signal that occurs twice, a signal on a reserved pin.
[[nodiscard]] Result<BoardHardware, Error> read_board_hardware(const std::filesystem::path& file);

}  // namespace octoskin::rig
