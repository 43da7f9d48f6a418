#include "firmware/core/bus_off_recovery.hpp"

#include <algorithm>
#include <utility>

namespace octoskin::node {

BusOffRecovery::BusOffRecovery(const Policy& policy) noexcept
    : policy_(policy), wait_(policy.bus_off_first) {}

BusOffRecovery::Action BusOffRecovery::update(CanState state, NodeTime now) noexcept {
    if (state == CanState::bus_off) return on_off(now);
    if (std::exchange(is_off_, false)) {
        back_since_ = now;
        return Action::resume;
    }
    if (back_since_ && elapsed(*back_since_, now) >= policy_.can_proven) {
        back_since_.reset();
        wait_ = policy_.bus_off_first;
    }
    return Action::none;
}

BusOffRecovery::Action BusOffRecovery::on_off(NodeTime now) noexcept {
    const bool is_news = !std::exchange(is_off_, true);
    back_since_.reset();
    if (is_news) {
        ++count_;
        try_at_ = now + wait_;
        return Action::discard;
    }
    if (!is_reached(try_at_, now)) return Action::none;
    // While the lines stay dominant the recovery never ends; requesting it again does no harm.
    wait_ = std::min(wait_ * 2, policy_.bus_off_longest);
    try_at_ = now + wait_;
    return Action::restart;
}

std::optional<NodeTime> BusOffRecovery::wake_time() const noexcept {
    if (is_off_) return try_at_;
    if (back_since_) return *back_since_ + policy_.can_proven;
    return std::nullopt;
}

}  // namespace octoskin::node
