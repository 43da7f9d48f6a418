#include "host/core/time/stamp_grain.hpp"

#include <algorithm>
#include <numeric>

namespace octoskin {

void StampGrain::take(WallTime stamp) noexcept {
    ++frames_;
    if (newest_ && stamp == *newest_) {
        ++equal_;
    } else if (newest_ && stamp > *newest_) {
        constexpr std::int64_t kMsNs = 1'000'000;
        const auto ms = static_cast<std::size_t>((stamp.ns - newest_->ns + kMsNs - 1) / kMsNs);
        ++gaps_[std::min(ms, kMsMax)];
    }
    newest_ = stamp;
}

Nanoseconds StampGrain::grain() const noexcept {
    if (10 * equal_ < frames_) return Nanoseconds{0};
    const std::uint64_t gaps = std::accumulate(gaps_.begin(), gaps_.end(), std::uint64_t{0});
    std::uint64_t below = 0;
    std::size_t ms = 0;
    while (ms < kMsMax && 10 * (below += gaps_[ms]) < 9 * gaps) ++ms;
    const Nanoseconds grain{static_cast<std::int64_t>(ms) * 1'000'000};
    return gaps == 0 || grain <= kHarmless ? Nanoseconds{0} : grain;
}

std::optional<std::string> describe_stamps(Nanoseconds grain) {
    if (grain.count() == 0) return std::nullopt;
    const std::string ms = std::to_string(grain.count() / 1'000'000);
    const std::string what =
        "the log's time stamps come in steps of " + ms +
        " ms, as those of a serial adapter (slcan) do: set its latency timer to 1 ms (echo 1 > "
        "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer, or setserial /dev/ttyUSB0 low_latency), and keep "
        "all decimals of the stamps";
    if (grain <= StampGrain::kBridgedMax) {
        return what +
               "; up to 16 ms are bridged: the time of a reading comes from its frames, SYNC and FOLLOW_UP";
    }
    return what + "; over 16 ms the turn of the clock of a reading cannot be determined (clock_in_doubt)";
}

}  // namespace octoskin
