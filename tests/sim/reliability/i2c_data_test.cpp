// I4, I5, I11: what is read is not what was measured, and what is done with what was. Which test shows which
// row: docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "common/range_status.hpp"
#include "tests/sim/reliability/oracles.hpp"
#include "tests/sim/reliability/transfers.hpp"

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;

// I4: the device lets go after byte number 0..16 of one of a result's two reads; all that follows reads as
// ones.
TEST(ReliabilityI4, a_read_cut_short_at_any_byte_makes_no_measurement) {
    NodeRig rig(fleet_config(2, 1), std::vector<SensorSetup>(2), kWrapsAfter5s);
    rig.run_for(1 * kSecond);
    for (std::uint32_t position = 0; position < 17; ++position) {
        for (std::uint64_t which = 0; which < 12; ++which) {
            rig.bus(0).inject({.kind = I2cFaultKind::read_ones,
                               .first = rig.bus(0).transfer_count() + which,
                               .position = position});
            rig.run_for(100 * kMillisecond);
        }
    }
    for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 1}) expect_only_the_truth(rig, sensor);
    EXPECT_GT(rig.node().counts().reads_disagreed, 0U);
}

// I5: each bit of each read of a bring-up: identity, boot, oscillator, and the whole configuration read back.
TEST(ReliabilityI5, no_bit_flipped_in_any_read_of_a_bring_up_makes_a_wrong_distance_or_loses_the_sensor) {
    const auto transfers = transfers_until_reading(1);
    std::uint32_t runs = 0;
    for (std::uint64_t which = 0; which < transfers.size(); ++which) {
        for (std::uint32_t bit = 0; bit < 8 * transfers[which].read; ++bit) {
            SCOPED_TRACE(testing::Message() << "transfer " << which << " bit " << bit);
            NodeRig rig(two_zones_config(1), std::vector<SensorSetup>(1),
                        wraps_after((20 + 11 * (runs % 50)) * kMillisecond));
            rig.bus(0).inject({.kind = I2cFaultKind::flip_bit, .first = which, .position = bit});
            rig.run_for(1'500 * kMillisecond);
            expect_only_the_truth(rig, 0);
            EXPECT_EQ(rig.last_health(0)->state, wire::SensorState::ranging);
            EXPECT_LE(longest_gap_us(rig, 0, 1'300'000), 3 * kPeriodUs);
            ++runs;
        }
    }
    EXPECT_GT(runs, 500U);
}

// I5: each bit of each read from one check of a group of registers to the next: polls, both reads of a
// result, the zone's read-back, the check, over both zones and all groups.
TEST(ReliabilityI5, no_bit_flipped_in_any_read_ever_makes_a_distance_that_was_not_measured) {
    for (std::uint64_t which = 0; which < 30; ++which) {
        NodeRig rig(two_zones_config(1), std::vector<SensorSetup>(1), kWrapsAfter5s);
        rig.run_for(500 * kMillisecond);
        for (std::uint32_t bit = 0; bit < 136; ++bit) {
            rig.bus(0).inject({.kind = I2cFaultKind::flip_bit,
                               .first = rig.bus(0).transfer_count() + which,
                               .position = bit});
            rig.run_for(4 * kPeriodUs * Microseconds{1});
        }
        expect_only_the_truth(rig, 0);
    }
}

// I5, found by the campaign: the loop or the bus stands for a while, and the poll that then comes too late is
// answered "not ready" by a flipped bit.
TEST(ReliabilityI5, a_bit_flipped_in_a_poll_after_a_stall_does_not_date_the_reading_to_the_stalls_end) {
    NodeConfig config = fleet_config(1, 1);
    config.sensors[0].inter_measurement_ms = 100;
    for (int stall_ms = 0; stall_ms < 100; stall_ms += 5) {
        for (std::uint64_t which = 0; which < 4; ++which) {
            SCOPED_TRACE(testing::Message() << stall_ms << " ms, transfer " << which);
            NodeRig rig(config, std::vector<SensorSetup>(1), wraps_after(4'100 * kMillisecond));
            rig.run_for(4 * kSecond);
            const std::size_t readings = rig.readings_of(0).size();
            while (rig.readings_of(0).size() == readings) rig.run_for(kMillisecond);
            rig.run_for(90 * kMillisecond);
            rig.hang_for(stall_ms * kMillisecond);
            rig.bus(0).inject({.kind = I2cFaultKind::flip_bit,
                               .first = rig.bus(0).transfer_count() + which,
                               .position = 7});
            rig.run_for(5 * kSecond);
            expect_only_the_truth(rig, 0);
        }
    }
}

// I11: the node hands every status and every distance on as it is, a negative one as 0; only "complete" of a
// first result, whose wrap-around was not checked, gets the code that says so. (What becomes a ray is the
// host's, tested there.)
TEST(ReliabilityI11, every_status_and_every_distance_goes_on_the_wire_as_it_is) {
    node::Policy policy;
    const node::ZoneCycle zones(1, Microseconds{1'000});
    std::uint64_t accepted = 0;
    for (std::uint8_t status = 0; status < 32; ++status) {
        node::Acceptance acceptance(StreamGate::advanced, Microseconds{20'000}, policy);
        NodeTime now{0xFFFF'FFFFU - 5'000'000U};
        acceptance.restart(now, Microseconds{33'000}, 10);
        std::uint8_t stream = 0;
        for (std::int32_t range_mm = -32'768; range_mm <= 32'767; ++range_mm) {
            now = now + Microseconds{33'000};
            acceptance.on_not_ready(now - Microseconds{200});
            acceptance.on_not_ready(now - Microseconds{100});
            vl53l1x::Measurement measurement;
            measurement.device_status = status;
            measurement.range_mm = static_cast<std::int16_t>(range_mm);
            measurement.stream_count = stream;
            const auto verdict =
                acceptance.judge({.measurement = measurement, .ready_seen = now, .read_end = now}, zones);
            ASSERT_EQ(verdict, node::Admission::accepted);
            const bool is_unchecked = stream == 0 && status == 9;
            ASSERT_EQ(acceptance.reading().device_status, is_unchecked ? 19 : status);
            ASSERT_EQ(acceptance.reading().range_mm, range_mm);
            ASSERT_EQ(node::range_on_wire(acceptance.reading()), std::max(range_mm, 0));
            ++accepted;
            stream = stream == 255 ? 128 : static_cast<std::uint8_t>(stream + 1);
        }
    }
    EXPECT_EQ(accepted, 32U * 65'536U);
}

}  // namespace
}  // namespace octoskin::test
