// When a reading was truly captured, and how far off its sensor admits to be.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <variant>
#include <vector>

#include "tests/support/node_rig.hpp"

namespace octoskin::test {

/// How far `said` was captured from `truth`, in microseconds of the node's clock: positive if said too late.
inline std::int64_t capture_error_us(const NodeRig& rig, const SaidReading& said, const TrueRange& truth) {
    const std::uint32_t true_us = rig.clock().to_node(truth.window_middle).us;
    const std::int64_t span_us = said.reading.capture.span_us;
    const std::int64_t ahead_us = (std::int64_t{said.reading.capture.value_us} - true_us) % span_us;
    return ahead_us > span_us / 2    ? ahead_us - span_us
           : ahead_us < -span_us / 2 ? ahead_us + span_us
                                     : ahead_us;
}

/// The last range of `sensor` before `said` that had this distance, which no other range has; null if none.
inline const TrueRange* truth_of(const NodeRig& rig, std::uint8_t sensor, const SaidReading& said) {
    const auto& ranges = rig.truth(sensor);
    const auto found = std::find_if(ranges.rbegin(), ranges.rend(), [&](const TrueRange& range) {
        return range.range_mm == said.reading.range_mm && range.window_middle < said.end;
    });
    return found == ranges.rend() ? nullptr : &*found;
}

/// The bounds of the capture error that a node told, of all its sensors.
class ToldBounds {
  public:
    explicit ToldBounds(const NodeRig& rig) {
        for (const auto& item : rig.said()) {
            const auto* health = std::get_if<wire::SensorHealth>(&item.message);
            if (health == nullptr) continue;
            reported_[health->sensor].push_back({item.end, health->capture_bound_64us * std::int64_t{64}});
        }
    }
    /// The largest told in the 1.1 s before a reading that was sent at `end`, or just after it: a larger
    /// bound than before is told at once, but a reading has the higher priority. 0 if none was.
    [[nodiscard]] std::int64_t at(std::uint8_t sensor, sim::SimTime end) const {
        const auto of_sensor = reported_.find(sensor);
        if (of_sensor == reported_.end()) return 0;
        std::int64_t largest_us = 0;
        for (const Told& reported : of_sensor->second) {
            const std::int64_t since_us = end.us - reported.when.us;
            if (since_us < 1'100'000 && since_us > -20'000)
                largest_us = std::max(largest_us, reported.bound_us);
        }
        return largest_us;
    }

  private:
    struct Told {
        sim::SimTime when{};
        std::int64_t bound_us = 0;
    };
    std::map<std::uint8_t, std::vector<Told>> reported_;
};

}  // namespace octoskin::test
