// I12, I13: a start that is interrupted, of the controller or of one sensor. Which test shows which row:
// docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;
using wire::SensorFault;
using wire::SensorState;

// I12: at 200 instants of a busy bus; the sensors keep power, addresses, and whatever byte they were sending.
TEST(ReliabilityI12, a_controller_reset_in_mid_transfer_starts_cleanly) {
    for (const bool is_xshut_kept : {false, true}) {
        NodeRig rig(fleet_config(4, 1), std::vector<SensorSetup>(4), kWrapsAfter5s);
        rig.run_for(1 * kSecond);
        for (int i = 0; i < 100; ++i) {
            rig.run_for(Microseconds{700'000 + 337 * i});
            rig.reset({.cause = wire::ResetCause::pin, .is_xshut_kept = is_xshut_kept});
            const std::int64_t reset_us = rig.now().us;
            rig.run_for(400 * kMillisecond);
            for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
                ASSERT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << i << ' ' << int{sensor};
                const auto readings = rig.readings_of(sensor);
                ASSERT_GT(readings.back().end.us, reset_us);
            }
        }
        for (std::uint8_t sensor = 0; sensor < 4; ++sensor) expect_only_the_truth(rig, sensor);
        EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
    }
}

// I13: the re-initialisation after a brown-out fails at its first, second, ... transfer: the next attempt,
// and the readings after it, are those of a sensor that starts from nothing.
TEST(ReliabilityI13, a_reinitialisation_that_fails_at_any_transfer_is_followed_by_a_clean_one) {
    for (std::uint64_t failing = 0; failing < 60; ++failing) {
        // The clock wraps somewhere from before the brown-out to after the last attempt.
        NodeRig rig(fleet_config(2, 1), std::vector<SensorSetup>(2),
                    wraps_after((590 + 7 * static_cast<int>(failing)) * kMillisecond));
        rig.run_for(600 * kMillisecond);
        const std::int64_t hurt_us = rig.now().us;
        rig.sensor(1).brown_out(rig.now());
        rig.bus(0).inject(
            {.kind = I2cFaultKind::nack_address, .first = rig.bus(0).transfer_count() + failing, .count = 2});
        rig.run_for(1'500 * kMillisecond);
        for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 1}) {
            EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << failing;
            EXPECT_LE(longest_gap_us(rig, sensor, hurt_us), 2 * kReinitialisedUs) << failing;
            expect_only_the_truth(rig, sensor);
        }
        EXPECT_EQ(rig.last_health(1)->fault == SensorFault::address_conflict, false);
    }
}

}  // namespace
}  // namespace octoskin::test
