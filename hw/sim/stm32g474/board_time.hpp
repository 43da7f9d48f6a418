// The emulated board's own time: the time of its crystal in picoseconds since power-up. A cycle of 160 MHz is
// a whole number of picoseconds, and 64 bits last for 106 days.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace octoskin::sim::stm32 {

struct BoardTime {
    std::int64_t ps = 0;
    friend constexpr auto operator<=>(BoardTime, BoardTime) = default;
};
inline constexpr BoardTime kNever{std::numeric_limits<std::int64_t>::max()};
inline constexpr std::int64_t kPsPerUs = 1'000'000;
inline constexpr std::int64_t kPsPerSecond = 1'000'000'000'000;

[[nodiscard]] constexpr BoardTime operator+(BoardTime time, std::int64_t ps) {
    return {time.ps + ps};
}
[[nodiscard]] constexpr std::int64_t period_ps(std::uint64_t hz) {
    return kPsPerSecond / static_cast<std::int64_t>(hz);
}
/// Whole periods of `hz` within `ps`; exact for any span.
[[nodiscard]] constexpr std::uint64_t periods_in(std::int64_t ps, std::uint64_t hz) {
    const auto whole = static_cast<std::uint64_t>(ps / kPsPerSecond);
    const auto part = static_cast<std::uint64_t>(ps % kPsPerSecond);
    // part < 1e12 and hz < 2^24 would not fit with hz up to 170e6, hence in two steps of 1e6.
    const std::uint64_t high = part / 1'000'000 * hz;
    const std::uint64_t low = part % 1'000'000 * hz;
    return whole * hz + (high + low / 1'000'000) / 1'000'000;
}
/// The shortest span that holds `periods` periods of `hz`.
[[nodiscard]] constexpr std::int64_t span_of(std::uint64_t periods, std::uint64_t hz) {
    const std::uint64_t rest = periods % hz;
    const std::uint64_t high = rest * 1'000'000;  // < 2^28 * 2^20
    const std::uint64_t part = high / hz * 1'000'000 + (high % hz * 1'000'000 + hz - 1) / hz;
    return static_cast<std::int64_t>(periods / hz) * kPsPerSecond + static_cast<std::int64_t>(part);
}

}  // namespace octoskin::sim::stm32
