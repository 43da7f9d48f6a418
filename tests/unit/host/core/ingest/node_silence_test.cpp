// What is found of a node of four sensors of which this and that does not come: when, and whether it is the
// node's or single sensors'.
#include "host/core/ingest/node_silence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/range_status.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "tests/support/bus/scripted_bus.hpp"

namespace octoskin {
namespace {

using test::ScriptedBus;

constexpr wire::NodeId kNode = 3;
constexpr wire::NodeId kOther = 4;
constexpr double kTick_s = 0.01;
constexpr double kEnd_s = 20.0;

/// Of the sensors each reading in 33 ms and SENSOR_HEALTH once a second, each at another time.
class NodeSilenceTest : public testing::Test {
  protected:
    NodeSilenceTest() {
        for (const wire::NodeId id : {kNode, kOther}) {
            HostNode node;
            node.node_id = id;
            node.node_hash = 7;
            node.sensors.resize(4);
            rig_.nodes.push_back(node);
        }
    }

    /// What is found from second to second of the bus, by its kind: "all" or the sensor's index, each with
    /// the first and the last time.
    struct Found {
        double first_s = 0.0;
        double last_s = 0.0;
    };
    using Findings = std::map<std::pair<std::string, SensorSilence>, Found>;
    Findings run() {
        CanIntake intake(rig_);
        Findings found;
        double looked_s = 0.0;
        for (StampedFrame entry : script().frames()) {
            if (entry.stamp >= test::wall_at(pause_from_s_)) entry.stamp.ns += pause_ns_;
            (void)intake.on_frame(entry.frame, entry.stamp);
            const auto now = intake.now();
            const double at_s = 1e-9 * static_cast<double>(entry.stamp.ns - test::kWallOffsetNs);
            if (!now || at_s < looked_s + kTick_s) continue;
            looked_s = at_s;
            if (intake.nodes().verdict(kNode, now) != NodeCondition::usable) continue;
            const NodeSilence silence = silence_of(intake.ranges(), rig_.nodes[0], *now);
            const auto note = [&](const std::string& of, SensorSilence what) {
                if (what == SensorSilence::none) return;
                found.try_emplace({of, what}, Found{at_s, 0.0}).first->second.last_s = at_s;
            };
            note("all", silence.of_all);
            for (const auto& sensor : silence.sensors) note(std::to_string(sensor.index), sensor.what);
        }
        return found;
    }

    static constexpr double kStop_s = 8.0;
    static constexpr double kGoOn_s = 14.0;
    static bool is_over(double at_s) { return at_s < kStop_s || at_s >= kGoOn_s; }

    /// What is lost is over two seconds after it: with the second SENSOR_HEALTH.
    static void expect_only(const std::string& of, const Findings& found) {
        for (const auto& [what, when] : found) {
            EXPECT_EQ(what.first, of) << when.first_s;
            EXPECT_LT(when.last_s, kGoOn_s + 2.1);
        }
    }

    HostRig rig_;
    int info_from_s_ = 0;
    double pause_from_s_ = kEnd_s;  ///< the bus is silent then, for pause_ns_
    std::int64_t pause_ns_ = 0;
    std::function<bool(std::uint8_t, double)> reading_comes_ = [](std::uint8_t, double) { return true; };
    std::function<bool(std::uint8_t, double)> health_comes_ = [](std::uint8_t, double) { return true; };
    std::function<bool(double)> node_is_heard_ = [](double) { return true; };
    std::function<wire::SensorState(std::uint8_t, double)> state_ = [](std::uint8_t, double) {
        return wire::SensorState::ranging;
    };

  private:
    ScriptedBus script() const {
        ScriptedBus bus;
        for (int second = 0; second < static_cast<int>(kEnd_s); ++second) {
            bus.exchange(0.1 + second, {kNode, kOther});
            for (int tenth = 0; tenth < 10; ++tenth) {
                const double at_s = second + 0.1 * tenth;
                bus.heartbeat(at_s + 0.001, rig_.nodes[1]);
                if (node_is_heard_(at_s)) bus.heartbeat(at_s, rig_.nodes[0]);
            }
            if (second >= info_from_s_) bus.info(0.02 + second, rig_.nodes[0]);
        }
        for (std::uint8_t sensor = 0; sensor < rig_.nodes[0].sensors.size(); ++sensor) add(bus, sensor);
        return bus;
    }
    void add(ScriptedBus& bus, std::uint8_t sensor) const {
        std::vector<double> sent_s;
        const double period_s = 1e-6 * static_cast<double>(rig_.nodes[0].sensors[sensor].period.count());
        for (double at_s = 0.3; at_s < kEnd_s; at_s += period_s) {
            if (state_(sensor, at_s) != wire::SensorState::ranging) continue;
            sent_s.push_back(at_s);
            wire::RangeReading reading;
            reading.sensor = sensor;
            reading.device_status = kDeviceStatusComplete;
            reading.range_mm = 1'000;
            if (reading_comes_(sensor, at_s) && node_is_heard_(at_s)) (void)bus.range(at_s, kNode, reading);
        }
        for (double at_s = 0.05 + 0.25 * sensor; at_s < kEnd_s; at_s += 1.0) {
            wire::SensorHealth health;
            health.sensor = sensor;
            health.state = state_(sensor, at_s);
            health.sent = static_cast<std::uint16_t>(std::ranges::lower_bound(sent_s, at_s) - sent_s.begin());
            if (health_comes_(sensor, at_s) && node_is_heard_(at_s)) bus.send(at_s, health, kNode);
        }
    }
};

// Heartbeats, NODE_INFO and SYNC_REPORT come: nothing else would tell.
TEST_F(NodeSilenceTest, is_a_nodes_of_which_neither_readings_nor_health_come_for_three_seconds) {
    reading_comes_ = health_comes_ = [](std::uint8_t, double at_s) { return is_over(at_s); };
    const Findings found = run();
    ASSERT_EQ(found.size(), 1U) << "no sensor is named beside it";
    const Found& of_all = found.at({"all", SensorSilence::unheard});
    EXPECT_GT(of_all.first_s, kStop_s + 2.9);
    EXPECT_LT(of_all.first_s, kStop_s + 3.1);
    EXPECT_GT(of_all.last_s, kGoOn_s - 0.2);
    EXPECT_LT(of_all.last_s, kGoOn_s + 0.1);
}

TEST_F(NodeSilenceTest, is_of_the_sensor_of_which_neither_comes) {
    reading_comes_ =
        health_comes_ = [](std::uint8_t sensor, double at_s) { return sensor != 2 || is_over(at_s); };
    const Findings found = run();
    ASSERT_EQ(found.size(), 1U);
    const Found& of_sensor = found.at({"2", SensorSilence::unheard});
    EXPECT_GT(of_sensor.first_s, kStop_s + 2.9);
    EXPECT_LT(of_sensor.first_s, kStop_s + 3.1);
    EXPECT_LT(of_sensor.last_s, kGoOn_s + 0.1);
}

TEST_F(NodeSilenceTest, is_of_what_never_spoke_once_its_node_has_been_usable_for_three_seconds) {
    for (const int info_from_s : {0, 9}) {
        info_from_s_ = info_from_s;
        reading_comes_ = health_comes_ = [](std::uint8_t sensor, double) { return sensor != 1; };
        const Findings of_one = run();
        ASSERT_EQ(of_one.size(), 1U);
        EXPECT_GT(of_one.at({"1", SensorSilence::unheard}).first_s, info_from_s + 2.9);
        EXPECT_LT(of_one.at({"1", SensorSilence::unheard}).first_s, info_from_s + 3.3);
        reading_comes_ = health_comes_ = [](std::uint8_t, double) { return false; };
        const Findings of_all = run();
        ASSERT_EQ(of_all.size(), 1U);
        EXPECT_GT(of_all.at({"all", SensorSilence::unheard}).first_s, info_from_s + 2.9);
        EXPECT_LT(of_all.at({"all", SensorSilence::unheard}).first_s, info_from_s + 3.3);
    }
}

TEST_F(NodeSilenceTest, is_none_of_what_is_well_or_says_that_it_does_not_range_or_speaks_seldom) {
    EXPECT_TRUE(run().empty());
    state_ = [](std::uint8_t sensor, double at_s) {
        return sensor == 0 && at_s > 5.0 ? wire::SensorState::stopped : wire::SensorState::ranging;
    };
    EXPECT_TRUE(run().empty());
    state_ = [](std::uint8_t, double) { return wire::SensorState::absent; };
    EXPECT_TRUE(run().empty());
    rig_.nodes[0].sensors[0].period = std::chrono::seconds(4);
    state_ = [](std::uint8_t, double) { return wire::SensorState::ranging; };
    EXPECT_TRUE(run().empty());
}

TEST_F(NodeSilenceTest, is_a_nodes_none_of_whose_readings_comes_and_first_of_no_single_sensor) {
    for (const int period_ms : {33, 1'500}) {
        rig_.nodes[0].sensors[0].period = std::chrono::milliseconds(period_ms);
        reading_comes_ = [](std::uint8_t, double at_s) { return is_over(at_s); };
        const Findings found = run();
        expect_only("all", found);
        const Found& of_all = found.at({"all", SensorSilence::no_readings});
        EXPECT_GT(of_all.first_s, kStop_s + 0.9);
        EXPECT_LT(of_all.first_s, kStop_s + 1.5 + 2e-3 * period_ms);
        EXPECT_LT(of_all.last_s, kGoOn_s + 0.1 + 1e-3 * period_ms);
    }
}

TEST_F(NodeSilenceTest, is_of_no_single_sensor_where_a_reading_of_another_gets_through_now_and_then) {
    reading_comes_ = [](std::uint8_t sensor, double at_s) {
        if (is_over(at_s)) return true;
        const int turn = static_cast<int>(at_s / 0.9);
        return turn % 4 == sensor && at_s - 0.9 * turn < 0.033;
    };
    const Findings found = run();
    expect_only("all", found);
    EXPECT_LT(found.at({"all", SensorSilence::no_readings}).first_s, kStop_s + 2.5);
}

TEST_F(NodeSilenceTest, is_of_a_sensor_most_of_whose_readings_are_lost_or_of_all_that_lose_as_much) {
    for (const bool is_of_all : {false, true}) {
        for (const int come_of_20 : {1, 8}) {
            reading_comes_ = [=](std::uint8_t sensor, double at_s) {
                return (sensor != 2 && !is_of_all) || is_over(at_s) ||
                       std::lround(at_s / 0.033) % 20 < come_of_20;
            };
            const Findings found = run();
            ASSERT_EQ(found.size(), 1U) << is_of_all << come_of_20;
            const Found& lost = found.at({is_of_all ? "all" : "2", SensorSilence::mostly_lost});
            EXPECT_GT(lost.first_s, kStop_s + 1.5);
            EXPECT_LT(lost.first_s, kStop_s + 4.1);
            EXPECT_LT(lost.last_s, kGoOn_s + 2.1);
        }
    }
}

TEST_F(NodeSilenceTest, is_of_none_of_whose_readings_forty_in_a_hundred_are_lost_or_all_for_a_second) {
    reading_comes_ = [](std::uint8_t sensor, double at_s) {
        return is_over(at_s) || (sensor == 2 && std::lround(at_s / 0.033) % 5 < 3) ||
               (sensor != 2 && at_s > kStop_s + 0.9);
    };
    EXPECT_TRUE(run().empty());
}

TEST_F(NodeSilenceTest, is_of_the_sensor_none_of_whose_readings_comes_also_beside_a_slow_one_alone) {
    for (const bool is_beside_slow : {false, true}) {
        if (is_beside_slow) {
            rig_.nodes[0].sensors[0].period = std::chrono::milliseconds(1'500);
            state_ = [](std::uint8_t sensor, double) {
                return sensor < 2 ? wire::SensorState::ranging : wire::SensorState::stopped;
            };
        }
        reading_comes_ = [](std::uint8_t sensor, double at_s) { return sensor != 1 || is_over(at_s); };
        const Findings found = run();
        expect_only("1", found);
        const Found& of_sensor = found.at({"1", SensorSilence::no_readings});
        EXPECT_GT(of_sensor.first_s, kStop_s + 0.9);
        EXPECT_LT(of_sensor.first_s, kStop_s + 3.0);
        EXPECT_LT(of_sensor.last_s, kGoOn_s + 0.1);
    }
}

// Lost it is named so itself; then what its sensors say is expected anew.
TEST_F(NodeSilenceTest, is_none_of_a_node_that_was_lost_nor_where_time_leapt) {
    node_is_heard_ = [](double at_s) { return is_over(at_s); };
    EXPECT_TRUE(run().empty());
    node_is_heard_ = [](double) { return true; };
    pause_from_s_ = 10.0;
    for (const std::int64_t pause_s : {2, 10, 3'600}) {
        pause_ns_ = pause_s * 1'000'000'000;
        EXPECT_TRUE(run().empty()) << pause_s;
    }
}

}  // namespace
}  // namespace octoskin
