// REFLEX on a bus that is busy with what is less urgent, and what it costs the rest.
#include <gtest/gtest.h>

#include <algorithm>

#include "firmware/core/transmit_places.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SensorSetup;

constexpr Microseconds kMillisecond{1'000};
constexpr Microseconds kSecond{1'000'000};
constexpr std::uint32_t kReflex = 0x005;

TEST(TransmitPlaces, are_three_of_which_one_is_for_reflex_and_never_two_for_one_identifier) {
    using Ids = std::vector<std::uint32_t>;
    EXPECT_TRUE(may_join({}, 0x145));
    EXPECT_TRUE(may_join(Ids{0x145}, 0x205));
    EXPECT_FALSE(may_join(Ids{0x145}, 0x145));
    EXPECT_FALSE(may_join(Ids{0x145, 0x205}, 0x1C5)) << "the last place is kept";
    EXPECT_TRUE(may_join(Ids{0x145, 0x205}, kReflex));
    EXPECT_FALSE(may_join(Ids{0x145, kReflex}, kReflex));
    EXPECT_FALSE(may_join(Ids{0x145, 0x205, 0x006}, kReflex));
}

// Heartbeats of others, back to back for 8 ms of every 10: below REFLEX, and above the node's readings.
TEST(NodeReflex, goes_out_within_5_ms_on_a_bus_that_is_busy_for_8_ms_of_10_with_what_is_less_urgent) {
    NodeConfig config = fleet_config(8, 4);
    config.uses_can_fd = false;
    config.aux_every = 1;  // so that there is always something less urgent that waits
    config.nominal_bitrate = 500'000;
    for (std::size_t i = 0; i < 8; ++i) config.sensors.at(i).reflex_below_mm = 300;
    NodeRig rig(config, std::vector<SensorSetup>(8));
    const auto frame_us =
        sim::frame_duration_us(wire::encode(wire::Heartbeat{}, 1), {.nominal = 500'000, .data = 500'000});
    for (int turn = 0; turn < 2'000; ++turn) {
        for (std::int64_t us = 0; us < 8'000; us += frame_us) {
            rig.send_from_host(wire::Heartbeat{}, static_cast<wire::NodeId>(1 + us / frame_us % 4));
        }
        rig.run_for(10 * kMillisecond);
    }
    const auto events = rig.said_of<wire::Reflex>();
    const auto times = rig.times_of<wire::Reflex>();
    ASSERT_GE(events.size(), 16U);
    for (std::size_t i = 0; i < events.size(); ++i) {
        const auto& ranges = rig.truth(events[i].sensor);
        const auto truth = std::find_if(ranges.rbegin(), ranges.rend(), [&](const test::TrueRange& range) {
            return range.range_mm == events[i].range_mm && range.window_middle < times[i];
        });
        ASSERT_NE(truth, ranges.rend());
        // Half the budget of 20 ms after the middle of its window the range is ready.
        EXPECT_LE(times[i].us - truth->window_middle.us, 10'000 + 5'000 + 1'000) << i;
    }
}

TEST(NodeReflex, of_all_sensors_at_once_goes_out_at_once_and_costs_the_heartbeat_nothing) {
    NodeConfig config = fleet_config(34, 4);
    std::vector<SensorSetup> setups(34);
    for (std::size_t i = 0; i < 34; ++i) {
        config.sensors.at(i).inter_measurement_ms = 1'000;  // few frames, few tokens
        config.sensors.at(i).reflex_below_mm = 500;
        setups[i].target = sim::RangingReturn{
            .range_m = 0.3, .sigma_m = 0.005, .peak_signal_mcps = 10.0, .ambient_mcps = 0.5};
    }
    NodeRig rig(config, setups);
    rig.run_for(5 * kSecond);
    const auto events = rig.times_of<wire::Reflex>();
    ASSERT_EQ(events.size(), 34U);
    EXPECT_LE(events.back().us - events.front().us, 60'000) << "as their sensors see it";
    const auto beats = rig.times_of<wire::Heartbeat>();
    ASSERT_EQ(beats.size(), 50U);
    for (std::size_t i = 1; i < beats.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(beats[i].us - beats[i - 1].us), 100'000.0, 10'000.0) << i;
    }
}

}  // namespace
}  // namespace octoskin::node
