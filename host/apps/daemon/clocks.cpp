#include "host/apps/daemon/clocks.hpp"

#include <ctime>

#include "common/wall_time.hpp"

namespace octoskin {
namespace {

timespec now_of(clockid_t clock) {
    timespec now{};
    ::clock_gettime(clock, &now);
    return now;
}

ClockPair read_once(const ClockReaders& readers) {
    const HostTime before = readers.monotonic();
    const WallTime wall = readers.wall();
    const Nanoseconds apart = readers.monotonic() - before;
    return {before + apart / 2, wall, apart};
}

}  // namespace

HostTime monotonic_now() {
    const timespec now = now_of(CLOCK_MONOTONIC);
    return {std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec};
}

WallTime wall_now() {
    const timespec now = now_of(CLOCK_REALTIME);
    return wall_time(now.tv_sec, now.tv_nsec);
}

ClockPair read_clocks(const ClockReaders& readers) {
    constexpr Nanoseconds kClose{20'000};
    constexpr int kTries = 8;
    ClockPair best = read_once(readers);
    for (int i = 1; i < kTries && best.doubt > kClose; ++i) {
        const ClockPair again = read_once(readers);
        if (again.doubt < best.doubt) best = again;
    }
    return best;
}

std::optional<HostTime> monotonic_of(WallTime stamp, const ClockReaders& readers) {
    constexpr Nanoseconds kAgeMax{1'000'000'000};
    constexpr Nanoseconds kDoubtMax{500'000};
    const ClockPair now = read_clocks(readers);
    const Nanoseconds age{now.wall.ns - stamp.ns};
    if (age < Nanoseconds{0} || age >= kAgeMax || now.doubt > kDoubtMax) return std::nullopt;
    return now.monotonic - age;
}

}  // namespace octoskin
