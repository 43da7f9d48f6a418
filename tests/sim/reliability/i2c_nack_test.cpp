// I1: an address or a byte that is not acknowledged. Which test shows which row:
// docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"
#include "tests/sim/reliability/transfers.hpp"

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;
using wire::SensorState;

struct Nack {
    I2cFaultKind kind;
    std::uint32_t position;
};

/// The address, the address after the repeated START, and each byte written.
std::vector<Nack> nacks_of(const TransferSize& transfer) {
    std::vector<Nack> all{{I2cFaultKind::nack_address, 0}};
    if (transfer.read > 0) all.push_back({I2cFaultKind::nack_read, 0});
    for (std::uint32_t byte = 0; byte < transfer.written; ++byte)
        all.push_back({I2cFaultKind::nack_byte, byte});
    return all;
}

// I1: once, at every byte of every transfer from the first one on, over both zones, a trim of the period and
// each group of registers that is read back: the retry makes it as if nothing had been. The clock wraps now
// before, now after it.
TEST(ReliabilityI1, a_nack_of_any_byte_of_any_transfer_costs_one_retry) {
    const auto transfers = transfers_until_reading(14);
    ASSERT_GT(transfers.size(), 100U);
    std::uint32_t runs = 0;
    std::uint32_t retries = 0;
    for (std::uint64_t first = 0; first < transfers.size(); ++first) {
        for (const Nack& nack : nacks_of(transfers[first])) {
            SCOPED_TRACE(testing::Message() << "transfer " << first << " position " << nack.position);
            NodeRig rig(two_zones_config(1), std::vector<SensorSetup>(1),
                        wraps_after((100 + 37 * (runs % 20)) * kMillisecond));
            rig.bus(0).inject({.kind = nack.kind, .first = first, .position = nack.position});
            rig.run_for(1 * kSecond);
            EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
            EXPECT_LE(rig.node().counts().i2c_errors, 1U);
            EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging);
            EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
            expect_only_the_truth(rig, 0);
            retries += rig.node().counts().i2c_errors;
            ++runs;
        }
    }
    EXPECT_GT(runs, 500U);
    // But for those that ask whether nobody is there.
    EXPECT_GE(retries + 10U, runs) << "the faults hardly did anything";
}

// I1: twice, and the sensor is lost; it comes back by itself, and its neighbour notices nothing.
TEST(ReliabilityI1, a_transfer_refused_twice_loses_that_sensor_alone_and_for_a_moment) {
    constexpr std::array<Nack, 7> kNacks = {{{I2cFaultKind::nack_address, 0},
                                             {I2cFaultKind::nack_read, 0},
                                             {I2cFaultKind::nack_byte, 0},
                                             {I2cFaultKind::nack_byte, 1},
                                             {I2cFaultKind::nack_byte, 2},
                                             {I2cFaultKind::nack_byte, 3},
                                             {I2cFaultKind::nack_byte, 5}}};
    for (const Nack& nack : kNacks) {
        for (std::int32_t offset = 0; offset < 30; ++offset) {
            NodeRig rig(two_zones_config(2), std::vector<SensorSetup>(2),
                        wraps_after((1'980 + 5 * offset) * kMillisecond));
            rig.run_for(2 * kSecond);  // up and trimmed
            const std::int64_t hurt_us = rig.now().us;
            rig.bus(0).inject({.kind = nack.kind,
                               .first = rig.bus(0).transfer_count() + static_cast<std::uint64_t>(offset),
                               .count = 12,
                               .position = nack.position,
                               .address = 0x31});
            rig.run_for(1 * kSecond);
            EXPECT_LE(longest_gap_us(rig, 1, hurt_us), kReinitialisedUs) << offset;
            EXPECT_LE(longest_gap_us(rig, 0, hurt_us), 2 * kPeriodUs + 5'000) << offset;
            EXPECT_EQ(rig.last_health(1)->state, SensorState::ranging) << offset;
            for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 1})
                expect_only_the_truth(rig, sensor);
        }
    }
}

TEST(ReliabilityI1, a_sensor_that_never_answers_is_absent_and_one_that_did_is_lost) {
    std::vector<SensorSetup> setups(2);
    setups[1].is_fitted = false;
    NodeRig rig(fleet_config(2, 1), setups);
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::absent);
    rig.sensor(0).set_faults({.is_absent = true});
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::lost);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 2);
}

}  // namespace
}  // namespace octoskin::test
