#include "firmware/core/reflex.hpp"

#include <algorithm>
#include <utility>

#include "common/range_status.hpp"

namespace octoskin::node {

bool Reflex::begins(const Reading& reading, NodeTime now) noexcept {
    if (is_far(reading)) {
        if (!far_since_) far_since_ = now;
        if (elapsed(*far_since_, now) >= policy_.reflex_rearm) is_armed_ = true;
        return false;
    }
    if (reading.device_status != kDeviceStatusComplete) return false;
    far_since_.reset();
    return reading.range_mm < limit_mm_ && std::exchange(is_armed_, false);
}

/// Limits the age of `far_since_`: an older time would look like a future one after the clock's wrap.
void Reflex::update(NodeTime now) noexcept {
    if (far_since_ && elapsed(*far_since_, now) > policy_.reflex_rearm) {
        far_since_ = now - policy_.reflex_rearm;
    }
}

bool Reflex::is_far(const Reading& reading) const noexcept {
    if (reading.device_status == kDeviceStatusNoTarget) return true;
    const std::int32_t margin =
        std::max(policy_.reflex_margin_mm, limit_mm_ * policy_.reflex_margin_permille / 1'000);
    return reading.device_status == kDeviceStatusComplete && reading.range_mm >= limit_mm_ + margin;
}

}  // namespace octoskin::node
