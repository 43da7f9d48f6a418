// Calibrations under every fault of the bus, and of a sensor that is reset at any moment of one.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "tests/unit/firmware/core/calibration_rig.hpp"

namespace octoskin::node::calibrations {
namespace {

// Every kind of fault, at every 23rd transfer of a calibration: it ends, what it calls done is right, and
// the sensor ranges again.
TEST(NodeCalibration, under_any_single_fault_of_its_bus_ends_and_never_with_a_wrong_value) {
    using sim::I2cFaultKind;
    const auto prepared = [] {
        auto rig = std::make_unique<NodeRig>(fleet_config(2, 2), setups_with(grey_target(0.170, 8.0)));
        rig->run_for(kSecond / 2);
        command(*rig, CommandCode::calibrate_offset, kBad, 140);
        return rig;
    };
    auto clean = prepared();
    const std::uint64_t first = clean->bus(1).transfer_count();
    while (outcomes(*clean).size() < 2) clean->run_for(kSecond / 100);
    const std::uint64_t transfers = clean->bus(1).transfer_count() - first;
    ASSERT_GT(transfers, 300U);
    int failed = 0;
    for (const I2cFaultKind kind :
         {I2cFaultKind::nack_address, I2cFaultKind::nack_byte, I2cFaultKind::nack_read,
          I2cFaultKind::flip_bit, I2cFaultKind::flip_written_bit, I2cFaultKind::lose_write,
          I2cFaultKind::read_ones, I2cFaultKind::lose_arbitration, I2cFaultKind::stretch,
          I2cFaultKind::sda_stuck_low}) {
        for (std::uint64_t n = 3 * static_cast<std::uint64_t>(kind); n < transfers; n += 23) {
            auto rig = prepared();
            rig->bus(1).inject(
                {.kind = kind, .first = first + n, .position = static_cast<std::uint32_t>(n % 19)});
            rig->run_for(5 * kSecond);
            ASSERT_EQ(outcomes(*rig).size(), 2U) << static_cast<int>(kind) << " at " << n;
            const Calibration end = answers(*rig).back();
            if (end.outcome == done) {
                EXPECT_NEAR(end.offset_quarter_mm, -68, 1) << static_cast<int>(kind) << " at " << n;
            } else {
                ++failed;
            }
            EXPECT_EQ(rig->last_health(kBad)->state, SensorState::ranging)
                << static_cast<int>(kind) << " at " << n;
        }
    }
    EXPECT_GT(failed, 0) << "the faults did nothing";
}

TEST(NodeCalibration, of_a_sensor_that_is_reset_in_the_middle_ends_and_it_ranges_as_configured) {
    for (int ms = 0; ms < 2'500; ms += 97) {
        NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
        rig.run_for(kSecond / 2);
        command(rig, CommandCode::calibrate_offset, kBad, 140);
        rig.run_for(ms * Microseconds{1'000});
        rig.sensor(kBad).brown_out(rig.now());
        rig.run_for(6 * kSecond);
        ASSERT_EQ(outcomes(rig).size(), 2U) << ms;
        const Calibration end = answers(rig).back();
        EXPECT_EQ(end.offset_quarter_mm, end.outcome == done ? -68 : 0) << ms;
        EXPECT_EQ(rig.last_health(kBad)->state, SensorState::ranging) << ms;
        EXPECT_EQ(last_range_mm(rig), 170) << "as configured";
    }
}

}  // namespace
}  // namespace octoskin::node::calibrations
