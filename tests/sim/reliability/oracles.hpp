// What the tests of the reliability goals ask of a node in simulation, again and again.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "tests/sim/capture_oracle.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::test {

inline constexpr Microseconds kMillisecond{1'000};
inline constexpr Microseconds kSecond{1'000'000};
/// Of the sensors of `fleet_config`.
inline constexpr std::int64_t kPeriodUs = 33'000;
/// reliability: 3 periods to notice, 300 ms to re-initialise, 2 periods to range.
inline constexpr std::int64_t kReinitialisedUs = 3 * kPeriodUs + 300'000 + 2 * kPeriodUs;
/// The clock of a node that wraps so long after the start.
inline sim::NodeClock wraps_after(Microseconds time) {
    return {NodeTime{} - time, 0.0};
}
inline const sim::NodeClock kWrapsAfter5s = wraps_after(5 * kSecond);

/// The longest time without a reading of `sensor` from `us` on.
inline std::int64_t longest_gap_us(const NodeRig& rig, std::uint8_t sensor, std::int64_t us) {
    std::int64_t longest = 0;
    std::int64_t last = us;
    for (const SaidReading& said : rig.readings_of(sensor)) {
        if (said.end.us < us) continue;
        longest = std::max(longest, said.end.us - last);
        last = said.end.us;
    }
    return std::max(longest, rig.now().us - last);
}

/// The longest time without a heartbeat from `us` on.
inline std::int64_t longest_silence_us(const NodeRig& rig, std::int64_t us) {
    std::int64_t longest = 0;
    std::int64_t last = us;
    for (const sim::SimTime time : rig.times_of<wire::Heartbeat>()) {
        if (time.us < us) continue;
        longest = std::max(longest, time.us - last);
        last = time.us;
    }
    return std::max(longest, rig.now().us - last);
}

/// What is wrong with the readings sent of `sensor`; empty if nothing is. Each must be one that this sensor
/// truly took: this distance, which no other sensor has, within the two seconds before, in this zone, at this
/// time; none twice, all in their order.
struct Untruth {
    sim::SimTime said{};
    std::string what;
};
inline std::vector<Untruth> untruths(const NodeRig& rig, std::uint8_t sensor) {
    // The bound that is told at most, and a poll that a flipped bit answered wrongly.
    constexpr std::int64_t kCaptureErrorMaxUs = 12'000;
    constexpr std::int64_t kAgeMaxUs = 2'000'000;
    const SensorConfig& config = rig.config().sensors.at(sensor);
    std::vector<Untruth> wrong;
    const auto& ranges = rig.truth(sensor);
    std::size_t next = 0;
    for (const SaidReading& said : rig.readings_of(sensor)) {
        const auto describe = [&](const std::string& what) {
            wrong.push_back({said.end, "sensor " + std::to_string(sensor) + " sent " +
                                           std::to_string(said.reading.range_mm) + " mm at " +
                                           std::to_string(said.end.us) + " us: " + what});
        };
        while (next < ranges.size() && ranges[next].window_middle.us < said.end.us - kAgeMaxUs) ++next;
        std::size_t found = next;
        while (found < ranges.size() && ranges[found].window_middle < said.end &&
               ranges[found].range_mm != said.reading.range_mm) {
            ++found;
        }
        if (found == ranges.size() || !(ranges[found].window_middle < said.end)) {
            describe("not measured of late, or sent already");
            continue;
        }
        next = found + 1;
        if (!(ranges[found].roi == config.zones.at(said.reading.zone))) describe("in another zone");
        const std::int64_t error_us = capture_error_us(rig, said, ranges[found]);
        if (std::abs(error_us) > kCaptureErrorMaxUs)
            describe("captured " + std::to_string(error_us) + " us beside the truth");
    }
    return wrong;
}

/// P1 as far as a node can keep it.
inline void expect_only_the_truth(const NodeRig& rig, std::uint8_t sensor) {
    const auto wrong = untruths(rig, sensor);
    EXPECT_TRUE(wrong.empty()) << wrong.size() << " readings, first: " << wrong.front().what;
}

/// P2: every reading accepted was sent, lost for a reason that was counted, or waits.
inline void expect_readings_accounted_for(const node::Node& node) {
    const node::NodeCounts counts = node.counts();
    EXPECT_EQ(counts.accepted,
              node.readings_sent() + counts.displaced + counts.late + counts.given_up + node.waiting());
}

/// The newest page of NODE_INFO of this kind.
template <class Page>
std::optional<Page> last_page(const NodeRig& rig) {
    std::optional<Page> last;
    for (const wire::NodeInfo& info : rig.said_of<wire::NodeInfo>()) {
        if (const auto* page = std::get_if<Page>(&info)) last = *page;
    }
    return last;
}

}  // namespace octoskin::test
