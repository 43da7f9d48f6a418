#include "firmware/core/frame_budget.hpp"

#include <algorithm>
#include <span>

#include "common/wire/messages.hpp"

namespace octoskin::node {

namespace {

constexpr std::uint32_t kHeartbeatsPerSecond = 10;
constexpr std::uint32_t kSyncReportsPerSecond = 1;
constexpr std::uint32_t kBurstMin = 8;
/// Two readings of something far, then one of something near: see `Reflex`.
constexpr std::uint32_t kReadingsPerEvent = 3;

}  // namespace

FrameBudgets frame_budgets(const NodeConfig& config) noexcept {
    std::uint32_t nominal = kHeartbeatsPerSecond + kSyncReportsPerSecond + wire::kInfoPages;
    std::uint32_t watching = 0;
    std::uint32_t readings_watched = 0;
    const auto count = std::min<std::size_t>(config.sensor_count, config.sensors.size());
    for (const SensorConfig& sensor : std::span(config.sensors).first(count)) {
        const std::uint32_t period_ms = std::max<std::uint32_t>(sensor.inter_measurement_ms, 1);
        const std::uint32_t readings = (1'000 + period_ms - 1) / period_ms;
        const bool has_aux = !config.uses_can_fd && config.aux_every > 0;
        const std::uint32_t aux = has_aux ? readings / config.aux_every + 1 : 0;
        nominal += readings + aux + 1;  // plus its health
        if (sensor.reflex_below_mm == 0) continue;
        ++watching;
        readings_watched += readings;
    }
    const FrameBudget reflex{.per_second = (readings_watched + kReadingsPerEvent - 1) / kReadingsPerEvent,
                             .burst = watching};
    const std::uint32_t burst = std::max(nominal / 4, kBurstMin);
    return {.reflex = reflex,
            .others = {.per_second = 2 * nominal - burst - reflex.per_second - reflex.burst, .burst = burst}};
}

}  // namespace octoskin::node
