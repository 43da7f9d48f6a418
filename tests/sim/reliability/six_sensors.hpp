// Six sensors on two buses, one of them to be hurt two seconds after the start; with the clock's wrap before
// that, at that moment, in the recovery, or never.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {

inline constexpr std::uint8_t kHurt = 2;
inline constexpr std::uint8_t kSensors = 6;
inline constexpr std::array<std::uint8_t, 3> kOnItsBus = {0, 2, 4};
inline constexpr std::array<std::uint8_t, 3> kOnTheOtherBus = {1, 3, 5};

class SixSensorsTest : public testing::TestWithParam<int> {
  protected:
    /// The parameter: milliseconds until the clock wraps.
    SixSensorsTest()
        : rig_(fleet_config(kSensors, 2), std::vector<SensorSetup>(kSensors),
               wraps_after(GetParam() * kMillisecond)) {
        rig_.run_for(2 * kSecond);
        hurt_us_ = rig_.now().us;
    }
    /// None but its own readings may suffer.
    void expect_neighbours_undisturbed() {
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            if (sensor == kHurt) continue;
            EXPECT_EQ(rig_.last_health(sensor)->state, wire::SensorState::ranging) << int{sensor};
            EXPECT_LE(longest_gap_us(rig_, sensor, hurt_us_), 2 * kPeriodUs + 5'000) << int{sensor};
        }
    }
    void expect_all_range() {
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            EXPECT_EQ(rig_.last_health(sensor)->state, wire::SensorState::ranging) << int{sensor};
            EXPECT_LE(longest_gap_us(rig_, sensor, rig_.now().us - 500'000), 2 * kPeriodUs) << int{sensor};
            expect_only_the_truth(rig_, sensor);
        }
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    }
    NodeRig rig_;
    std::int64_t hurt_us_ = 0;
};

/// For `INSTANTIATE_TEST_SUITE_P`.
inline auto wraps() {
    return testing::Values(1'000, 2'005, 2'040, 2'200, 1'000'000);
}
inline std::string wrap_name(const testing::TestParamInfo<int>& of) {
    return "and_the_clock_wraps_after_" + std::to_string(of.param) + "_ms";
}

}  // namespace octoskin::test
