// I2C transfers as text, so that a test can contain a bus trace as it was logged:
//
//     W 0087 40                register index and bytes of a write
//     R 0089 2 -> 09 ??        register index and length of a read, and the bytes read; ?? is any byte
//     R 0089 2 ! timeout       a transfer that fails, a write as well: with a name of i2c::TransferError
//     ADDRESS 2A               the 7-bit address from here on, 29 at first
//     WAIT 110                 milliseconds
//
// One entry a line, or several separated by '|'; '#' starts a comment.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/drivers/i2c/i2c_bus.hpp"

namespace octoskin::test {

struct TraceEntry {
    std::string text{};  ///< as written, for messages
    std::uint32_t wait_ms = 0;
    i2c::Address address = 0x29;
    std::vector<std::uint8_t> write{};                ///< index included
    std::vector<std::optional<std::uint8_t>> read{};  ///< empty: no read
    std::optional<i2c::TransferError> error{};        ///< instead of an answer
    [[nodiscard]] bool is_wait() const noexcept { return wait_ms != 0; }
};

using Trace = std::vector<TraceEntry>;

/// Throws std::invalid_argument with the entry's text if it cannot be parsed.
[[nodiscard]] Trace parse_trace(std::string_view text);

}  // namespace octoskin::test
