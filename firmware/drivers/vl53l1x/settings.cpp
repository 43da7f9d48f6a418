#include "firmware/drivers/vl53l1x/settings.hpp"

#include <algorithm>
#include <span>

#include "firmware/drivers/vl53l1x/roi.hpp"
#include "firmware/drivers/vl53l1x/timing.hpp"

namespace octoskin::vl53l1x {

bool is_supported(const Settings& settings) noexcept {
    if (settings.zone_count < 1 || settings.zone_count > settings.zones.size()) return false;
    const auto zones = std::span(settings.zones).first(settings.zone_count);
    return range_timeouts(settings.distance_mode, settings.timing_budget_ms) &&
           is_period_long_enough(settings.timing_budget_ms, settings.inter_measurement_ms) &&
           (!settings.has_offset || is_offset_supported(settings.offset_quarter_mm)) &&
           std::all_of(zones.begin(), zones.end(), [](const Roi& roi) { return is_supported(roi); });
}

}  // namespace octoskin::vl53l1x
