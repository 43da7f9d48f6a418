#include "firmware/port/stm32g4/can_entry.hpp"

namespace octoskin::stm32g4 {

void CanEntry::begin(const std::optional<CanRates>& rates, wire::NodeId node_id, std::uint32_t clock_hz,
                     NodeTime now) {
    rates_ = rates;
    node_id_ = node_id;
    clock_hz_ = clock_hz;
    if (clock_hz_ != 0) enter(now);
}

void CanEntry::poll(NodeTime now) {
    if (clock_hz_ == 0) return;
    // Stored rather than compared each time: the clock wraps after 72 minutes on the bus.
    has_paused_ = has_paused_ || is_reached(try_at_, now);
    if (can_.is_started()) return;
    if (can_.is_listening()) return judge(now);
    if (has_paused_) enter(now);
}

void CanEntry::enter(NodeTime now) {
    try_at_ = now + kPause;
    has_paused_ = false;
    if (rates_) {
        (void)can_.start(*rates_, node_id_, clock_hz_);
    } else {
        search_.begin(now);
        (void)can_.listen(search_.rates(), node_id_, clock_hz_);
    }
}

void CanEntry::judge(NodeTime now) {
    switch (search_.judge(can_.heard(), now)) {
        case RateSearch::NextStep::wait:
            break;
        case RateSearch::NextStep::try_next:
            (void)can_.listen(search_.rates(), node_id_, clock_hz_);
            break;
        case RateSearch::NextStep::found:
            (void)can_.join();
            break;
    }
}

}  // namespace octoskin::stm32g4
