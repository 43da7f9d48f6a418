// Zones on the way from the sensor to the wire. Oracle: the region of interest with which the modelled sensor
// truly took each range.
#include <gtest/gtest.h>

#include <array>

#include "common/range_pause.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SaidReading;
using test::SensorSetup;
using test::TrueRange;

constexpr Microseconds kSecond{1'000'000};
constexpr std::array<Roi, 3> kZones = {Roi{.centre_spad = 167, .width = 8, .height = 16},
                                       Roi{.centre_spad = 231, .width = 8, .height = 16},
                                       Roi{.centre_spad = 199, .width = 6, .height = 6}};

NodeConfig zoned_config(std::uint8_t count, std::uint8_t buses) {
    NodeConfig config = fleet_config(count, buses);
    for (auto& sensor : config.sensors) {
        sensor.zone_count = 3;
        std::copy(kZones.begin(), kZones.end(), sensor.zones.begin());
    }
    return config;
}

const TrueRange* truth_of(const NodeRig& rig, std::uint8_t sensor, const SaidReading& said) {
    const TrueRange* found = nullptr;
    for (const TrueRange& range : rig.truth(sensor)) {
        if (range.range_mm == said.reading.range_mm && range.window_middle < said.end) found = &range;
    }
    return found;
}

/// Of which the part measured another zone than they say.
int wrong_zones(const NodeRig& rig, std::uint8_t sensor, const std::vector<SaidReading>& readings) {
    int wrong = 0;
    for (const SaidReading& said : readings) {
        const TrueRange* truth = truth_of(rig, sensor, said);
        wrong += truth == nullptr || truth->roi != kZones.at(said.reading.zone) ? 1 : 0;
    }
    return wrong;
}

TEST(NodeZones, tells_the_zone_in_which_each_range_was_truly_taken) {
    for (const double slow_clock_factor : {1.00, 1.075, 1.15}) {
        std::vector<SensorSetup> setups(6);
        for (auto& setup : setups) setup.part.slow_clock_factor = slow_clock_factor;
        NodeRig rig(zoned_config(6, 2), setups);
        rig.run_for(10 * kSecond);
        for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
            std::array<int, 3> count{};
            for (const SaidReading& said : rig.readings_of(sensor)) {
                const TrueRange* truth = truth_of(rig, sensor, said);
                ASSERT_NE(truth, nullptr);
                ASSERT_LT(said.reading.zone, 3);
                EXPECT_EQ(truth->roi, kZones.at(said.reading.zone));
                ++count.at(said.reading.zone);
            }
            for (const int readings : count) EXPECT_GE(readings, 80) << int{sensor};
        }
    }
}

struct ZonedRate {
    DistanceMode mode;
    std::uint16_t budget_ms;
    std::uint16_t period_ms;
};

/// What a range takes before its window is not public: each of the six parts takes another time, from nothing
/// to all that the firmware allows for.
NodeRig rig_of(const ZonedRate& rate) {
    NodeConfig config = zoned_config(6, 3);
    std::vector<SensorSetup> setups(6);
    for (std::uint8_t i = 0; i < 6; ++i) {
        SensorConfig& sensor = config.sensors[i];
        sensor.distance_mode = rate.mode;
        sensor.timing_budget_ms = rate.budget_ms;
        sensor.inter_measurement_ms = rate.period_ms;
        sensor.phase_us = static_cast<std::uint16_t>(1'000U * rate.period_ms * i / 6);
        setups[i].part.range_overhead = kRangeOverheadMax * i / 5;
        setups[i].part.slow_clock_factor = 1.04 + 0.01 * i;
    }
    return {config, setups};
}

// A slow loop writes zones anywhere in the pause between two ranges, and beyond it.
TEST(NodeZones, never_tells_a_wrong_zone_however_long_before_its_window_a_range_begins) {
    constexpr std::array<ZonedRate, 8> kRates{{{DistanceMode::short_range, 15, 20},
                                               {DistanceMode::short_range, 15, 24},
                                               {DistanceMode::long_range, 20, 25},
                                               {DistanceMode::long_range, 20, 29},
                                               {DistanceMode::long_range, 20, 33},
                                               {DistanceMode::long_range, 33, 40},
                                               {DistanceMode::long_range, 33, 50},
                                               {DistanceMode::long_range, 100, 111}}};
    for (const ZonedRate& rate : kRates) {
        for (const std::int64_t step_us : {0, 300, 1'000, 1'700}) {
            NodeRig rig = rig_of(rate);
            if (step_us == 0) {
                rig.run_for(5 * kSecond);
            } else {
                rig.run_in_steps_for(5 * kSecond, Microseconds{step_us});
            }
            for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
                const auto readings = rig.readings_of(sensor);
                EXPECT_GE(readings.size(), 20U);
                EXPECT_EQ(wrong_zones(rig, sensor, readings), 0)
                    << "of " << readings.size() << ": overhead " << int{sensor} << " ms, period "
                    << rate.period_ms << " ms, step " << step_us << " us";
            }
        }
    }
}

// Those periods that a rig file may have at the least, with three zones.
TEST(NodeZones, cycles_where_the_pause_between_two_ranges_is_just_long_enough) {
    constexpr std::array<ZonedRate, 4> kRates{{{DistanceMode::short_range, 15, 24},
                                               {DistanceMode::long_range, 20, 29},
                                               {DistanceMode::long_range, 33, 42},
                                               {DistanceMode::long_range, 100, 109}}};
    for (const ZonedRate& rate : kRates) {
        NodeRig rig = rig_of(rate);
        rig.run_for(20 * kSecond);
        for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
            const auto readings = rig.readings_of(sensor);
            std::array<std::size_t, 3> count{};
            for (const SaidReading& said : readings) ++count.at(said.reading.zone);
            for (const std::size_t of_zone : count)
                EXPECT_GE(of_zone, readings.size() / 4) << rate.period_ms << " ms, " << int{sensor};
        }
    }
}

TEST(NodeZones, drops_and_counts_readings_rather_than_guess_their_zone) {
    NodeConfig config = zoned_config(4, 1);
    config.zone_guard_us = 14'000;  // longer than the 13 ms between two ranges: no write can ever be safe
    NodeRig rig(config, std::vector<SensorSetup>(4));
    rig.run_for(5 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
        for (const SaidReading& said : rig.readings_of(sensor)) EXPECT_EQ(said.reading.zone, 0);
    }
}

TEST(NodeZones, knows_the_zone_after_forty_minutes_at_rest) {
    // Longer than half the clock's period, when times of before would look like times to come.
    NodeConfig config = zoned_config(1, 1);
    config.sensors[0].zone_count = 2;
    NodeRig rig(config, std::vector<SensorSetup>(1));
    rig.run_for(1 * kSecond);
    rig.send_from_host(wire::Command{.code = wire::CommandCode::stop}, 5);
    rig.run_for(40 * 60 * kSecond);
    const std::size_t before = rig.readings_of(0).size();
    rig.send_from_host(wire::Command{.code = wire::CommandCode::start}, 5);
    rig.run_for(2 * kSecond);
    const auto readings = rig.readings_of(0);
    ASSERT_GE(readings.size(), before + 50);
    for (std::size_t i = before; i < readings.size(); ++i) {
        const TrueRange* truth = truth_of(rig, 0, readings[i]);
        ASSERT_NE(truth, nullptr);
        EXPECT_EQ(truth->roi, kZones.at(readings[i].reading.zone)) << i;
    }
}

// A loop that has become too slow for the pause between two ranges writes no zone any more: the last write
// lies ever further back, until its time looks like one to come.
TEST(NodeZones, knows_the_zone_forty_minutes_after_it_was_last_written) {
    NodeConfig config = zoned_config(1, 1);
    config.sensors[0].timing_budget_ms = 500;
    config.sensors[0].inter_measurement_ms = 510;
    NodeRig rig(config, std::vector<SensorSetup>(1));
    rig.run_for(20 * kSecond);
    const auto first = rig.readings_of(0);
    ASSERT_GE(first.size(), 20U);
    ASSERT_NE(first.back().reading.zone, first.at(first.size() - 2).reading.zone) << "it cycles";
    rig.run_in_steps_for(45 * 60 * kSecond, Microseconds{2'500});
    const auto readings = rig.readings_of(0);
    ASSERT_GE(readings.size(), 4'000U);
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const TrueRange* truth = truth_of(rig, 0, readings[i]);
        ASSERT_NE(truth, nullptr);
        ASSERT_EQ(truth->roi, kZones.at(readings[i].reading.zone)) << i << ' ' << readings[i].end.us;
    }
    for (std::size_t i = first.size() + 10; i < readings.size(); ++i)
        ASSERT_EQ(readings[i].reading.zone, readings.back().reading.zone) << "no zone was written " << i;
}

TEST(NodeZones, notices_a_zone_that_was_not_written_as_meant) {
    NodeRig rig(zoned_config(1, 1), std::vector<SensorSetup>(1));
    rig.run_for(2 * kSecond);
    for (std::uint64_t i = 0; i < 40; ++i) {
        rig.bus(0).inject(
            {.kind = sim::I2cFaultKind::lose_write, .first = rig.bus(0).transfer_count() + 211 * i});
    }
    rig.run_for(20 * kSecond);
    int readings = 0;
    for (const SaidReading& said : rig.readings_of(0)) {
        const TrueRange* truth = truth_of(rig, 0, said);
        ASSERT_NE(truth, nullptr);
        EXPECT_EQ(truth->roi, kZones.at(said.reading.zone)) << said.end.us;
        ++readings;
    }
    EXPECT_GE(readings, 300);
    EXPECT_GE(rig.node().counts().sensor_restarts, 1U);
}

}  // namespace
}  // namespace octoskin::node
