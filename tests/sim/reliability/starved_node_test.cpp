// A node whose loop is kept from running, for as long as an operating system may keep it: between two polls
// and in the middle of a reading, for microseconds or for seconds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <random>
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
std::vector<std::pair<sim::SimTime, std::int64_t>> bounds_told(const NodeRig& rig, std::uint8_t sensor) {
    std::vector<std::pair<sim::SimTime, std::int64_t>> told;
    for (const SaidMessage& item : rig.said()) {
        const auto* health = std::get_if<wire::SensorHealth>(&item.message);
        if (health != nullptr && health->sensor == sensor)
            told.emplace_back(item.end, health->capture_bound_64us * std::int64_t{64});
    }
    return told;
}

/// Readings whose capture time is further from the truth than the sensor told: last before the reading, which
/// may have waited since, or first after it, when the loop came to that.
int beyond_their_bounds(const NodeRig& rig, std::uint8_t sensor) {
    const auto told = bounds_told(rig, sensor);
    int beyond = 0;
    for (const SaidReading& said : rig.readings_of(sensor)) {
        const TrueRange* truth = truth_of(rig, sensor, said);
        if (truth == nullptr) continue;  // expect_only_the_truth says so
        const auto after =
            std::ranges::find_if(told, [&](const auto& item) { return item.first >= said.end; });
        const auto before = after - std::min<std::ptrdiff_t>(after - told.begin(), 2);
        std::int64_t bound_us = 0;
        for (auto item = before; item != told.end() && item <= after; ++item)
            bound_us = std::max(bound_us, item->second);
        const std::int64_t error_us = std::abs(capture_error_us(rig, said, *truth));
        if (error_us <= bound_us) continue;
        ++beyond;
        ADD_FAILURE() << "off by " << error_us << " us, told " << bound_us << ", at " << said.end.us;
    }
    return beyond;
}

TEST(StarvedNode, sends_nothing_but_the_truth_whenever_and_for_however_long_its_loop_is_kept_waiting) {
    std::size_t readings = 0;
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        NodeConfig config = fleet_config(4, 2);
        config.data_ready_buses = seed % 2 == 0 ? 0b01 : 0;
        std::vector<SensorSetup> setups(4);
        for (std::size_t i = 0; i < setups.size(); ++i) {
            setups[i].part.slow_clock_factor = 1.03 + 0.02 * static_cast<double>(i);
            setups[i].part.range_overhead = Microseconds{1'000 * static_cast<std::int64_t>(i)};
        }
        NodeRig rig(config, setups, wraps_after(20 * kSecond));
        rig.run_for(kSecond);
        while (rig.now().us < 60 * kSecond.count()) {
            rig.run_for(
                Microseconds{1 + static_cast<std::int64_t>(random() % (random() % 4 == 0 ? 60'000 : 1'500))});
            rig.hang_for(pause(random));
        }
        for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
            expect_only_the_truth(rig, sensor);
            EXPECT_EQ(beyond_their_bounds(rig, sensor), 0) << "sensor " << int{sensor};
            readings += rig.readings_of(sensor).size();
        }
        expect_readings_accounted_for(rig.node());
    }
    EXPECT_GE(readings, 10'000U);
}

}  // namespace
}  // namespace octoskin::test
