#include "firmware/port/linux/node_clock.hpp"

#include <limits>

#include "common/wall_time.hpp"

namespace octoskin::linux_port {
namespace {

std::int64_t read_ns(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

WallTime wall_now() noexcept {
    timespec time{};
    ::clock_gettime(CLOCK_REALTIME, &time);
    return wall_time(time.tv_sec, time.tv_nsec);
}

NodeTime node_time(std::int64_t monotonic_ns) noexcept {
    return {static_cast<std::uint32_t>(static_cast<std::uint64_t>(monotonic_ns / 1'000))};
}

}  // namespace

NodeTime node_now() noexcept {
    return node_time(read_ns(CLOCK_MONOTONIC));
}

ClockPair read_clocks() noexcept {
    constexpr int kTries = 3;
    ClockPair best;
    std::int64_t best_width_ns = std::numeric_limits<std::int64_t>::max();
    for (int i = 0; i < kTries; ++i) {
        const std::int64_t before_ns = read_ns(CLOCK_MONOTONIC);
        const WallTime wall = wall_now();
        const std::int64_t width_ns = read_ns(CLOCK_MONOTONIC) - before_ns;
        if (width_ns >= best_width_ns) continue;
        best_width_ns = width_ns;
        best = {.node = node_time(before_ns + width_ns / 2), .wall = wall};
    }
    return best;
}

NodeTime node_time_of(WallTime stamp, const ClockPair& now) noexcept {
    constexpr std::int64_t kAgeMaxNs = 1'000'000'000;
    const std::int64_t age_ns = now.wall.ns - stamp.ns;
    if (age_ns < 0 || age_ns > kAgeMaxNs) return now.node;
    return now.node - Microseconds{age_ns / 1'000};
}

}  // namespace octoskin::linux_port
