// What the node says, when, and how much of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/wire/crc.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SaidReading;
using test::SensorSetup;

constexpr Microseconds kMillisecond{1'000};
constexpr Microseconds kSecond{1'000'000};

NodeConfig classical_config(std::uint8_t count, std::uint8_t aux_every = 0) {
    NodeConfig config = fleet_config(count, 4);
    config.uses_can_fd = false;
    config.aux_every = aux_every;
    config.nominal_bitrate = 500'000;
    return config;
}

std::vector<SensorSetup> fleet(std::size_t count) {
    return std::vector<SensorSetup>(count);
}

template <class Page>
Page last_page(const NodeRig& rig) {
    Page last;
    for (const wire::NodeInfo& info : rig.said_of<wire::NodeInfo>()) {
        if (const auto* page = std::get_if<Page>(&info)) last = *page;
    }
    return last;
}

TEST(NodeFrames, beats_at_ten_hertz_give_or_take_ten_milliseconds_from_the_first_millisecond_on) {
    NodeRig rig(classical_config(17), fleet(17));
    rig.run_for(5 * kSecond);
    const auto times = rig.times_of<wire::Heartbeat>();
    ASSERT_EQ(times.size(), 50U);
    EXPECT_LE(times.front().us, 1'000);
    for (std::size_t i = 1; i < times.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(times[i].us - times[i - 1].us), 100'000.0, 10'000.0);
    }
}

TEST(NodeFrames, tells_in_its_heartbeat_who_it_is_and_how_it_stands) {
    const NodeConfig config = fleet_config(3, 1);
    NodeRig rig(config, fleet(3));
    rig.run_for(50 * kMillisecond);
    const std::array<std::uint8_t, 12> uid = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back(),
              (wire::Heartbeat{.state = wire::NodeState::starting,
                               .reset_cause = wire::ResetCause::pin,
                               .uid_crc = crc16(uid),
                               .node_hash_low = static_cast<std::uint16_t>(node_hash(config) & 0xFFFFU)}));
    rig.run_for(500 * kMillisecond);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().state, wire::NodeState::ranging);
}

TEST(NodeFrames, tells_the_rest_in_the_pages_of_node_info) {
    const NodeConfig config = fleet_config(3, 1);
    NodeRig rig(config, fleet(3));
    rig.run_for(5'900 * kMillisecond);
    EXPECT_EQ(last_page<wire::InfoUidLow>(rig).uid, (std::array<std::uint8_t, 6>{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(last_page<wire::InfoUidHigh>(rig).uid, (std::array<std::uint8_t, 6>{7, 8, 9, 10, 11, 12}));
    EXPECT_EQ(last_page<wire::InfoIdentity>(rig),
              (wire::InfoIdentity{.node_hash = node_hash(config), .sensor_count = 3, .board_type = 0}));
    EXPECT_EQ(last_page<wire::InfoBuild>(rig).build_id, 0x1234ABCDU);
    EXPECT_EQ(last_page<wire::InfoBuild>(rig).uptime_s, 5);
    EXPECT_EQ(last_page<wire::InfoCounters>(rig), wire::InfoCounters{});
    EXPECT_EQ(last_page<wire::InfoTraffic>(rig), wire::InfoTraffic{});
    EXPECT_EQ(last_page<wire::InfoFault>(rig), wire::InfoFault{});
}

TEST(NodeFrames, sends_every_page_and_every_sensors_health_once_a_second) {
    NodeRig rig(fleet_config(5, 2), fleet(5));
    rig.run_for(3 * kSecond);
    const std::size_t pages = rig.said_of<wire::NodeInfo>().size();
    const std::size_t healths = rig.said_of<wire::SensorHealth>().size();
    rig.run_for(10 * kSecond);
    EXPECT_NEAR(static_cast<double>(rig.said_of<wire::NodeInfo>().size() - pages), 70.0, 1.0);
    // On change comes on top: the bound on the capture time varies a little.
    EXPECT_GE(rig.said_of<wire::SensorHealth>().size() - healths, 50U);
    EXPECT_LE(rig.said_of<wire::SensorHealth>().size() - healths, 120U);
}

TEST(NodeFrames, numbers_readings_without_a_gap_and_counts_them_in_the_health) {
    for (const bool uses_can_fd : {true, false}) {
        NodeConfig config = classical_config(5);
        config.uses_can_fd = uses_can_fd;
        NodeRig rig(config, fleet(5));
        rig.run_for(4 * kSecond);
        for (std::uint8_t sensor = 0; sensor < 5; ++sensor) {
            const auto readings = rig.readings_of(sensor);
            ASSERT_GE(readings.size(), 100U);
            for (std::size_t i = 0; i < readings.size(); ++i) {
                ASSERT_EQ(readings[i].reading.sequence, i % 64) << int{sensor};
            }
            const std::size_t reported = rig.last_health(sensor)->sent;
            EXPECT_LE(reported, readings.size());
            EXPECT_GE(reported + 40, readings.size());
            EXPECT_EQ(rig.last_health(sensor)->rejected, 0);
        }
    }
}

TEST(NodeFrames, marks_only_the_first_reading_of_a_run_as_unchecked_for_wrap_around) {
    NodeRig rig(fleet_config(3, 1), fleet(3));
    rig.run_for(400 * kMillisecond);
    for (std::uint8_t sensor = 0; sensor < 3; ++sensor) {
        const auto readings = rig.readings_of(sensor);
        ASSERT_GE(readings.size(), 3U);
        EXPECT_EQ(readings[0].reading.device_status, 19);
        EXPECT_EQ(readings[1].reading.device_status, 9);
        EXPECT_EQ(readings[2].reading.device_status, 9);
    }
}

TEST(NodeFrames, tell_a_smaller_bound_on_the_capture_time_once_the_rhythm_is_known) {
    // Three sensors that start at once hinder each other's first polls.
    NodeConfig config = fleet_config(3, 1);
    for (auto& sensor : config.sensors) sensor.phase_us = 0;
    NodeRig rig(config, fleet(3));
    rig.run_for(350 * kMillisecond);
    const int at_first = rig.last_health(1)->capture_bound_64us;
    rig.run_for(4 * kSecond);
    EXPECT_LT(rig.last_health(1)->capture_bound_64us, at_first);
    EXPECT_LE(rig.last_health(1)->capture_bound_64us * 64, 256);
}

TEST(NodeFrames, puts_readings_that_come_together_into_one_fd_frame) {
    NodeConfig config = fleet_config(4, 4);
    for (auto& sensor : config.sensors) sensor.phase_us = 0;  // one sensor a bus, all at once
    std::vector<SensorSetup> setups = fleet(4);
    for (auto& setup : setups) setup.part.slow_clock_factor = 1.075;
    NodeRig rig(config, setups);
    rig.run_for(1 * kSecond);
    const auto frames = rig.said_of<wire::RangeFd>();
    ASSERT_GE(frames.size(), 15U);
    const auto full = std::count_if(frames.begin(), frames.end(),
                                    [](const wire::RangeFd& frame) { return frame.count == 4; });
    EXPECT_GE(static_cast<std::size_t>(full), frames.size() - 2);
}

TEST(NodeFrames, adds_signal_figures_to_every_fifth_classical_reading) {
    NodeRig rig(classical_config(2, 5), fleet(2));
    rig.run_for(4 * kSecond);
    const auto aux = rig.said_of<wire::RangeAux>();
    const std::size_t readings = rig.said_of<wire::Range>().size();
    EXPECT_NEAR(static_cast<double>(aux.size()), static_cast<double>(readings) / 5.0, 2.0);
    for (const wire::RangeAux& item : aux) {
        EXPECT_EQ(item.signal, (wire::SignalReading{.peak_signal = 1'280, .ambient = 64}));  // 10, 0.5 Mcps
    }
}

// The device's range register is signed: uncalibrated, a target that all but touches the sensor comes out
// behind it.
TEST(NodeFrames, say_of_a_target_nearer_than_the_offset_error_that_it_is_at_0_mm_and_begin_the_reflex) {
    for (const bool uses_can_fd : {true, false}) {
        NodeConfig config = classical_config(1);
        config.uses_can_fd = uses_can_fd;
        config.sensors[0].reflex_below_mm = 100;
        config.sensors[0].has_offset = true;  // of 0, where the part needs 13 mm: 5 mm seem -8 mm
        std::vector<SensorSetup> setups = fleet(1);
        setups[0].target = sim::RangingReturn{
            .range_m = 0.005, .sigma_m = 0.005, .peak_signal_mcps = 10.0, .ambient_mcps = 0.5};
        NodeRig rig(config, setups);
        rig.run_for(1 * kSecond);
        const auto readings = rig.readings_of(0);
        ASSERT_GT(readings.size(), 15U);
        for (const SaidReading& said : readings) ASSERT_EQ(said.reading.range_mm, 0);
        EXPECT_EQ(readings.back().reading.device_status, 9);
        const auto reflexes = rig.said_of<wire::Reflex>();
        ASSERT_EQ(reflexes.size(), 1U);
        EXPECT_EQ(reflexes[0].range_mm, 0);
    }
}

// Mailboxes that are given free one by one are full for every kind of frame now and then.
TEST(NodeFrames, lose_no_frame_that_had_to_wait_for_a_mailbox) {
    NodeConfig config = classical_config(8, 1);
    for (std::size_t i = 0; i < 8; ++i) config.sensors.at(i).reflex_below_mm = 500;
    NodeRig rig(config, fleet(8));
    rig.run_for(400 * kMillisecond);
    for (int i = 0; i < 400; ++i) {
        rig.leave_unacknowledged(true);
        rig.run_for(Microseconds{3'000 + 37 * i % 4'000});
        rig.leave_unacknowledged(false);
        rig.run_for(Microseconds{2'000});
    }
    rig.run_for(100 * kMillisecond);
    const NodeCounts counts = rig.node().counts();
    EXPECT_EQ(counts.given_up + counts.others_given_up + counts.late + counts.displaced + counts.others_late,
              0U);
    for (std::uint8_t sensor = 0; sensor < 8; ++sensor) {
        const auto readings = rig.readings_of(sensor);
        ASSERT_GT(readings.size(), 50U);
        for (std::size_t i = 1; i < readings.size(); ++i) {
            ASSERT_EQ(readings[i].reading.sequence,
                      static_cast<std::uint8_t>((readings[i - 1].reading.sequence + 1) % 64));
        }
    }
    const auto reflexes = rig.said_of<wire::Reflex>();
    ASSERT_GE(reflexes.size(), 8U) << "everything is near at first";
    for (std::size_t i = 0; i < reflexes.size(); ++i) EXPECT_EQ(reflexes[i].sequence, i % 64);
}

TEST(NodeFrames, keeps_the_newest_reading_while_nothing_can_be_sent_and_counts_the_others) {
    NodeRig rig(fleet_config(3, 1), fleet(3));
    rig.run_for(2 * kSecond);
    const NodeCounts before = rig.node().counts();
    EXPECT_EQ(before.displaced + before.late, 0U);
    const std::size_t sent_before = rig.readings_of(1).size();
    const std::size_t measured_before = rig.truth(1).size();

    rig.block_transmission(true);
    const std::uint64_t polls = rig.poll_count();
    rig.run_for(1 * kSecond);
    EXPECT_LE(rig.poll_count() - polls, 6'000U) << "it tries again every millisecond, not all the time";
    rig.block_transmission(false);
    rig.run_for(10 * kMillisecond);
    const NodeCounts after = rig.node().counts();
    // 30 readings of each of 3 sensors: each displaced by the next, as 50 ms are longer than a period
    EXPECT_NEAR(static_cast<double>(after.displaced), 3 * 30.0, 6.0);
    EXPECT_EQ(after.late, 0U);
    const auto readings = rig.readings_of(1);
    ASSERT_GT(readings.size(), sent_before);
    EXPECT_EQ(readings[sent_before].reading.range_mm, rig.truth(1).back().range_mm);
    EXPECT_EQ(readings[sent_before].reading.sequence, (readings[sent_before - 1].reading.sequence + 1) % 64);
    EXPECT_GE(rig.truth(1).size() - measured_before, 29U);
}

TEST(NodeFrames, drops_and_counts_readings_that_are_too_old_to_be_sent) {
    NodeConfig config = fleet_config(1, 1);
    config.sensors[0].inter_measurement_ms = 200;
    NodeRig rig(config, fleet(1));
    rig.run_for(3 * kSecond);
    rig.block_transmission(true);
    rig.run_for(2 * kSecond);
    const NodeCounts counts = rig.node().counts();
    EXPECT_NEAR(static_cast<double>(counts.late), 10.0, 1.0);
    EXPECT_EQ(counts.displaced, 0U);
    rig.block_transmission(false);
    rig.run_for(1'500 * kMillisecond);
    EXPECT_EQ(last_page<wire::InfoTraffic>(rig).late_dropped, counts.late);
}

TEST(NodeFrames, never_exceeds_twice_its_nominal_rate_however_often_it_is_asked) {
    NodeRig rig(classical_config(4), fleet(4));
    rig.run_for(2 * kSecond);
    for (int i = 0; i < 1'500; ++i) {
        const auto sequence = static_cast<std::uint8_t>(i);
        rig.send_from_host(wire::Command{.code = wire::CommandCode::send_info, .sequence = sequence}, 5);
        rig.run_for(2 * kMillisecond);
    }
    std::vector<std::int64_t> times_us;
    for (const auto& item : rig.said()) {
        if (!std::holds_alternative<wire::Command>(item.message)) times_us.push_back(item.end.us);
    }
    // 4 sensors at 31 readings a second, rounded up, and their healths; 10 heartbeats, 7 pages, 1 report
    const std::size_t limit = 2 * (4 * 31 + 4 + 10 + 7 + 1);
    std::size_t most = 0;
    for (std::size_t first = 0, last = 0; last < times_us.size(); ++last) {
        while (times_us[last] - times_us[first] >= 1'000'000) ++first;
        most = std::max(most, last - first + 1);
    }
    EXPECT_LE(most, limit + 3);  // mailboxes that were full at the window's beginning
    EXPECT_GE(most, limit - 40);
    EXPECT_GE(rig.readings_of(0).size(), 140U) << "readings must go before answers";
}

TEST(NodeFrames, are_the_same_for_the_same_inputs) {
    const auto run = [] {
        std::vector<SensorSetup> setups = fleet(9);
        setups[4].part.slow_clock_factor = 1.02;
        setups[5].faults.freezes_stream = true;
        NodeRig rig(fleet_config(9, 4), setups, sim::NodeClock{{123'456}, 40.0});
        rig.run_for(2 * kSecond);
        return rig.frames();
    };
    const auto first = run();
    EXPECT_GE(first.size(), 300U);
    EXPECT_EQ(first, run());
}

TEST(NodeFrames, go_on_unchanged_over_the_wrap_of_the_nodes_clock) {
    // 5 s before the wrap, and a clock that does not wrap.
    std::vector<std::vector<std::int64_t>> heartbeats_us;
    std::vector<std::size_t> readings;
    for (const std::uint32_t at_start : {0xFFFFFFFFU - 5'000'000U, 1'000'000U}) {
        NodeRig rig(fleet_config(6, 2), fleet(6), sim::NodeClock{{at_start}, 0.0});
        rig.run_for(8 * kSecond);
        EXPECT_EQ(rig.node().counts().rejected, 0U);
        EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
        std::size_t count = 0;
        for (std::uint8_t sensor = 0; sensor < 6; ++sensor) count += rig.readings_of(sensor).size();
        readings.push_back(count);
        EXPECT_EQ(rig.times_of<wire::Heartbeat>().size(), 80U);
    }
    EXPECT_NEAR(static_cast<double>(readings[0]), static_cast<double>(readings[1]), 8.0);
}

}  // namespace
}  // namespace octoskin::node
