#include "firmware/core/data_ready_hint.hpp"

#include <algorithm>
#include <utility>

namespace octoskin::node {

namespace {

// A confirmed fall offsets this many spurious ones. Two in three may be spurious, as when sensors of the bus
// are restarted again and again; a chattering line has more.
constexpr std::uint16_t kDoubtLifted = 2;

}  // namespace

bool DataReadyHint::take(NodeTime now) {
    if (lines_ == nullptr || is_ignored()) return false;
    if (asked_again_at_ && !is_reached(*asked_again_at_, now)) return false;
    asked_again_at_.reset();
    if (!lines_->take_fall(bus_)) return false;
    asked_again_at_ = now + policy_.hint_interval;
    if (std::exchange(is_unconfirmed_, true)) {
        ++spurious_count_;
        ++doubt_;
    }
    return !is_ignored();
}

void DataReadyHint::confirm() noexcept {
    if (!std::exchange(is_unconfirmed_, false)) return;
    doubt_ = static_cast<std::uint16_t>(doubt_ - std::min(doubt_, kDoubtLifted));
}

}  // namespace octoskin::node
