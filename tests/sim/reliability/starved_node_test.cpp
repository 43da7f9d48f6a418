// A node whose loop is kept from running, for as long as an operating system may keep it: between two polls
// and in the middle of a reading, for microseconds or for seconds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {
namespace {

/// Mostly short, now and then longer than a period, rarely longer than all that a stream count can tell.
Microseconds pause(std::mt19937& random) {
    constexpr std::array<std::int64_t, 10> kLongestUs{300,    300,    1'000,   1'000,   3'000,
                                                      10'000, 30'000, 100'000, 500'000, 6'000'000};
    const std::int64_t longest_us = kLongestUs.at(random() % kLongestUs.size());
    // Half of the longest ones are not even so long, or nothing would be ranged between them.
    const bool is_long = longest_us > 100'000 && random() % 20 != 0;
    return Microseconds{1 + static_cast<std::int64_t>(random()) % (is_long ? 30'000 : longest_us)};
}

/// Bounds that were told of a sensor, in steps of 64 us.
std::vector<std::pair<sim::SimTime, std::int64_t>> bounds_reported(const NodeRig& rig, std::uint8_t sensor) {
    std::vector<std::pair<sim::SimTime, std::int64_t>> reported;
    for (const SaidMessage& item : rig.said()) {
        const auto* health = std::get_if<wire::SensorHealth>(&item.message);
        if (health != nullptr && health->sensor == sensor)
            reported.emplace_back(item.end, health->capture_bound_64us * std::int64_t{64});
    }
    return reported;
}

/// One that was put together before the reading may still come between it and the one that tells of it.
constexpr Microseconds kToldLateMax{50'000};

/// Readings whose capture time is further from the truth than the sensor told: last before the range or
/// since, for the reading may have waited, or first after the reading, when the loop came to that.
int beyond_their_bounds(const NodeRig& rig, std::uint8_t sensor) {
    const auto reported = bounds_reported(rig, sensor);
    int beyond = 0;
    for (const SaidReading& said : rig.readings_of(sensor)) {
        const TrueRange* truth = truth_of(rig, sensor, said);
        if (truth == nullptr) continue;  // expect_only_the_truth says so
        const auto first_at = [&reported](sim::SimTime time) {
            return std::ranges::find_if(reported, [time](const auto& item) { return item.first >= time; });
        };
        const auto after = first_at({said.end.us + kToldLateMax.count()});
        const auto since = first_at(said.end);
        const auto before = since - std::min<std::ptrdiff_t>(since - reported.begin(), 2);
        std::int64_t bound_us = 0;
        for (auto item = std::min(before, first_at(truth->window_middle));
             item != reported.end() && item <= after; ++item)
            bound_us = std::max(bound_us, item->second);
        const std::int64_t error_us = std::abs(capture_error_us(rig, said, *truth));
        if (error_us <= bound_us) continue;
        ++beyond;
        ADD_FAILURE() << "off by " << error_us << " us, told " << bound_us << ", at " << said.end.us;
    }
    return beyond;
}

/// Whatever a rig may choose that decides when a result is read and how its time is found.
NodeConfig any_config(std::mt19937& random) {
    const auto draw = [&random](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    constexpr std::array kGates{StreamGate::advanced, StreamGate::advanced, StreamGate::differs,
                                StreamGate::off};
    NodeConfig config = fleet_config(4, 2);
    config.holds_phases = draw(2) == 0;
    config.data_ready_buses = static_cast<std::uint8_t>(draw(4));
    config.uses_can_fd = draw(2) == 0;
    config.stream_gate = kGates.at(draw(kGates.size()));
    config.reads_twice = draw(4) != 0;
    const bool is_short = draw(3) == 0;
    for (SensorConfig& sensor : std::span(config.sensors).first(config.sensor_count)) {
        if (is_short) {
            sensor.distance_mode = DistanceMode::short_range;
            sensor.timing_budget_ms = 15;
            sensor.inter_measurement_ms = static_cast<std::uint16_t>(22 + draw(6));
            sensor.phase_us = static_cast<std::uint16_t>(draw(20'000));
        }
        if (draw(2) == 0) continue;
        sensor.zone_count = 2;
        sensor.zones[0] = {.centre_spad = 167, .width = 8, .height = 16};
        sensor.zones[1] = {.centre_spad = 231, .width = 8, .height = 8};
    }
    return config;
}

std::vector<SensorSetup> any_parts(std::mt19937& random, std::size_t count) {
    std::vector<SensorSetup> setups(count);
    for (SensorSetup& setup : setups) {
        setup.part.slow_clock_factor = 1.0 + 0.0001 * static_cast<double>(random() % 1'600);
        setup.part.range_overhead = Microseconds{static_cast<std::int64_t>(random() % 4'900)};
    }
    return setups;
}

TEST(StarvedNode, sends_nothing_but_the_truth_whenever_and_for_however_long_its_loop_is_kept_waiting) {
    std::size_t readings = 0;
    for (std::uint32_t seed = 1; seed <= 100; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        const NodeConfig config = any_config(random);
        NodeRig rig(config, any_parts(random, config.sensor_count), wraps_after(20 * kSecond));
        rig.run_for(kSecond);
        while (rig.now().us < 60 * kSecond.count()) {
            rig.run_for(
                Microseconds{1 + static_cast<std::int64_t>(random() % (random() % 4 == 0 ? 60'000 : 1'500))});
            rig.hang_for(pause(random));
        }
        // What is told of the last readings comes a little later.
        rig.run_for(2 * kSecond);
        for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
            expect_only_the_truth(rig, sensor);
            EXPECT_EQ(beyond_their_bounds(rig, sensor), 0) << "sensor " << int{sensor};
            readings += rig.readings_of(sensor).size();
        }
        expect_readings_accounted_for(rig.node());
    }
    EXPECT_GE(readings, 100'000U);
}

}  // namespace
}  // namespace octoskin::test
