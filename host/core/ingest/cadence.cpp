#include "host/core/ingest/cadence.hpp"

#include <algorithm>
#include <chrono>

#include "common/wire/messages.hpp"

namespace octoskin {
namespace {

/// Capture times are known to about 0.3 ms. A period changes by thousandths from one range to the next.
constexpr Nanoseconds kToleranceMax{3'000'000};
/// The mean over this many consecutive ranges is the period. A longer span may hide a wrap of the numbers.
constexpr int kMeasuredMax = 8;

/// Signed distance of two sequence numbers, -31 to 32.
int steps(std::uint8_t from, std::uint8_t to) {
    constexpr int kTurn = wire::kSequenceCount;
    const int ahead = (to - from + kTurn) % kTurn;
    return ahead > kTurn / 2 ? ahead - kTurn : ahead;
}

}  // namespace

bool Cadence::fits(std::uint8_t sequence, HostTime captured) const {
    if (!step_) {
        return false;
    }
    const int ahead = steps(step_->sequence, sequence);
    const Nanoseconds off = captured - step_->captured - period_ * ahead;
    return ahead != 0 && std::chrono::abs(off) <= std::min(period_ / 8, kToleranceMax);
}

void Cadence::on_accepted(std::uint8_t sequence, HostTime captured) {
    const Step step{sequence, captured};
    step_ = !step_ || fits(sequence, captured) ? step : step_;
    before_ = newest_;
    newest_ = step;
}

void Cadence::confirm() {
    if (!newest_) {
        return;
    }
    const int apart = before_ ? steps(before_->sequence, newest_->sequence) : 0;
    if (apart > 0 && apart <= kMeasuredMax) {
        period_ = (newest_->captured - before_->captured) / apart;
    }
    step_ = newest_;
}

}  // namespace octoskin
