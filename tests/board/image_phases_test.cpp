// The flashed image: sensors of a bus keep taking turns.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "tests/board/image_fleets.hpp"
#include "tests/support/turns.hpp"

namespace octoskin::sim::stm32 {
namespace {

using namespace std::chrono_literals;

/// Twenty seconds, the last ten of them judged: tests/sim/phases_test has whole minutes.
struct HeldFleet {
    std::string name;
    NodeConfig config;
    Speed speed;
    double off_max_us = 0.0;  ///< of its phase
};
void PrintTo(const HeldFleet& fleet, std::ostream* out) {
    *out << fleet.name;
}

class ImagePhases : public testing::TestWithParam<HeldFleet> {};

TEST_P(ImagePhases, sensors_keep_taking_turns_where_the_rig_asks_for_it) {
    constexpr double kPeakOverMeanMax = 1.5;
    constexpr SimTime kSettled{10'000'000};
    NodeConfig config = GetParam().config;
    config.holds_phases = true;
    test::spread_phases(config);
    const double period_us = 1'000.0 * config.sensors[0].inter_measurement_ms;
    FlashedBoard flashed(config, options_of(GetParam().speed));
    flashed.run_for(20s);
    std::vector<std::vector<double>> middles_us(config.sensor_count);
    std::array<std::vector<double>, kNodeBusesMax> of_bus_us;
    double ranges = 0.0;
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
        for (const SimTime middle : flashed.windows(sensor)) {
            if (middle < kSettled) continue;
            middles_us[sensor].push_back(static_cast<double>(middle.us));
            of_bus_us.at(config.sensors[sensor].bus).push_back(static_cast<double>(middle.us));
            ranges += 1.0;
        }
        expect_unbroken(flashed.readings(sensor));
    }
    double peak = 0.0;
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        const auto sensors = static_cast<double>(
            std::count_if(config.sensors.begin(), config.sensors.begin() + config.sensor_count,
                          [bus](const SensorConfig& sensor) { return sensor.bus == bus; }));
        peak = std::max(peak, test::peak_over_mean(of_bus_us.at(bus), sensors, period_us));
    }
    EXPECT_LE(peak, kPeakOverMeanMax);
    std::vector<double> phases_us;
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor)
        phases_us.push_back(config.sensors[sensor].phase_us);
    const double off_us = test::worst_off_us(middles_us, phases_us, period_us);
    EXPECT_LE(off_us, GetParam().off_max_us);
    const double overlap_us = test::worst_needless_overlap_us(config, middles_us);
    EXPECT_LE(overlap_us, 1'000.0);
    const double missing = 1.0 - ranges / (config.sensor_count * 10e6 / period_us);
    EXPECT_LE(missing, 0.04);
    std::printf(
        "%d sensors: busiest 5 ms %.2f of the mean, at most %.2f ms off its phase, %.2f ms at once beyond "
        "need, %.1f %% of the ranges given for it\n",
        config.sensor_count, peak, off_us * 1e-3, overlap_us * 1e-3, 100.0 * missing);
    EXPECT_EQ(flashed.violations(), "");
}

// A core that takes three cycles an instruction knows ready times less well, the more so where edges are as
// slow as the specification allows. At 30 Hz a sensor may walk farther before it is started anew.
INSTANTIATE_TEST_SUITE_P(
    Fleets, ImagePhases,
    testing::Values(HeldFleet{"34_at_30_hz", thirty_four_at_30_hz(), {1, BusEdges::typical}, 450.0},
                    HeldFleet{"34_at_30_hz_slow_core", thirty_four_at_30_hz(), {3, BusEdges::typical}, 600.0},
                    HeldFleet{"17_at_50_hz", seventeen_at_50_hz(), {1, BusEdges::typical}, 400.0},
                    HeldFleet{"17_at_50_hz_slow_core", seventeen_at_50_hz(), {3, BusEdges::typical}, 550.0},
                    HeldFleet{"17_at_50_hz_slow_edges", seventeen_at_50_hz(), {3, BusEdges::slowest}, 550.0}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace octoskin::sim::stm32
