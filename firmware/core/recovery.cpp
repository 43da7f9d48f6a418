#include "firmware/core/recovery.hpp"

#include <algorithm>

namespace octoskin::node {

RecoveryPlan Recovery::on_failure(bool can_restart, NodeTime now) noexcept {
    proven_in_row_ = 0;
    const bool is_first = failures_ == 0;
    failures_ = static_cast<std::uint8_t>(std::min(failures_ + 1, 255));
    if (is_first && can_restart) return {.step = RecoveryStep::restart, .at = now};
    return {.step = RecoveryStep::xshut_cycle, .at = now + next_backoff()};
}

Microseconds Recovery::next_backoff() noexcept {
    const Microseconds wait = backoff_;
    backoff_ = backoff_.count() == 0 ? policy_.backoff_first : std::min(backoff_ * 2, policy_.backoff_max);
    return wait;
}

void Recovery::on_proven_reading() noexcept {
    if (failures_ == 0) return;
    if (++proven_in_row_ >= policy_.proven_readings_until_healthy) reset();
}

void Recovery::reset() noexcept {
    failures_ = 0;
    proven_in_row_ = 0;
    backoff_ = Microseconds{0};
}

}  // namespace octoskin::node
