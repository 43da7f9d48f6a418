// What the tests of the reliability goals ask of a node in simulation, again and again.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>

#include "tests/support/node_rig.hpp"

namespace octoskin::test {

inline constexpr Microseconds kMillisecond{1'000};
inline constexpr Microseconds kSecond{1'000'000};
/// Of the sensors of `fleet_config`.
inline constexpr std::int64_t kPeriodUs = 33'000;
/// reliability: 3 periods to notice, 300 ms to re-initialise, 2 periods to range.
inline constexpr std::int64_t kReinitialisedUs = 3 * kPeriodUs + 300'000 + 2 * kPeriodUs;
/// The clock of a node that wraps 5 s after the start.
inline const sim::NodeClock kWrapsAfter5s{{0xFFFF'FFFFU - 5'000'000U}, 0.0};

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

/// P1 as far as a node can keep it: every distance sent of `sensor` was truly measured, each once and in this
/// order.
inline void expect_only_the_truth(NodeRig& rig, std::uint8_t sensor) {
    std::size_t truth = 0;
    const auto& ranges = rig.truth(sensor);
    for (const SaidReading& said : rig.readings_of(sensor)) {
        while (truth < ranges.size() && ranges[truth].range_mm != said.reading.range_mm) ++truth;
        ASSERT_LT(truth, ranges.size())
            << "sensor " << int{sensor} << " sent " << said.reading.range_mm << " mm at " << said.end.us;
        ++truth;
    }
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
