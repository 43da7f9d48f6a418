// Duration of a transfer on the wire, and the deadline derived from it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/time.hpp"
#include "firmware/drivers/i2c/i2c_bus.hpp"

namespace octoskin::i2c {

/// Clock periods of a transfer without clock stretching. Each byte takes 8 bits and an acknowledge; START and
/// STOP take one each. A read after a write adds a repeated START and a second address byte.
[[nodiscard]] constexpr std::uint32_t bit_count(std::size_t bytes_written, std::size_t bytes_read) noexcept {
    const auto written = static_cast<std::uint32_t>(bytes_written);
    const auto read = static_cast<std::uint32_t>(bytes_read);
    if (read == 0) return (1 + written) * 9 + 2;
    if (written == 0) return (1 + read) * 9 + 2;
    return (2 + written + read) * 9 + 3;
}
[[nodiscard]] constexpr std::uint32_t bit_count(const Transfer& transfer) noexcept {
    return bit_count(transfer.write.size(), transfer.read.size());
}

/// Time after which a transfer is given up: three times its nominal time, for devices and ports that stretch
/// the clock, plus `lateness` for a late interrupt or thread. `bus_hz` > 0.
[[nodiscard]] constexpr Microseconds time_limit(const Transfer& transfer, std::uint32_t bus_hz,
                                                Microseconds lateness = Microseconds{1'000}) noexcept {
    const std::uint64_t nominal_us = (std::uint64_t{bit_count(transfer)} * 1'000'000 + bus_hz - 1) / bus_hz;
    return Microseconds{static_cast<std::int64_t>(3 * nominal_us)} + lateness;
}

}  // namespace octoskin::i2c
