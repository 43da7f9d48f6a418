// The flashed image, whatever an I2C bus does: the main loop stays short, the other buses go on, and the bus
// comes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/board/image_fleets.hpp"

namespace octoskin::sim::stm32 {
namespace {

using namespace std::chrono_literals;

struct FaultCase {
    I2cFault fault;
};
void PrintTo(const FaultCase& tested, std::ostream* out) {
    constexpr const char* kNames[] = {"nack_address",     "nack_byte",    "nack_read", "flip_bit",
                                      "flip_written_bit", "lose_write",   "read_ones", "lose_arbitration",
                                      "stretch",          "sda_stuck_low"};
    *out << kNames[static_cast<std::size_t>(tested.fault.kind)] << "_at_" << tested.fault.position;
}
/// Between two of its readings, and to now.
std::int64_t longest_gap_us(FlashedBoard& flashed, std::uint8_t sensor, SimTime from) {
    std::int64_t longest_us = 0;
    std::int64_t last_us = from.us;
    for (const SaidReading& said : flashed.readings(sensor)) {
        if (said.end < from) continue;
        longest_us = std::max(longest_us, said.end.us - last_us);
        last_us = said.end.us;
    }
    return std::max(longest_us, flashed.now().us - last_us);
}

class I2cFaultTest : public testing::TestWithParam<FaultCase> {};

TEST_P(I2cFaultTest, keeps_the_loop_short_and_the_others_ranging) {
    const NodeConfig config = thirty_four_at_30_hz();
    FlashedBoard flashed(config, options_of({3, BusEdges::slowest}));
    flashed.run_for(2s);
    const std::vector<Counts> before = counts_of(flashed, config.sensor_count);
    flashed.board().forget_longest_awake();
    const SimTime began = flashed.now();
    I2cFault fault = GetParam().fault;
    const std::uint64_t hits_before = flashed.board().wire(0).fault_hits();
    // A poll is too short for some: then another transfer.
    for (int attempt = 0; attempt < 20 && flashed.board().wire(0).fault_hits() == hits_before; ++attempt) {
        fault.first = flashed.board().wire(0).transfer_count() + 3;
        flashed.board().wire(0).inject(fault);
        flashed.run_for(100ms);
    }
    flashed.run_for(2s);

    EXPECT_GE(flashed.board().wire(0).fault_hits() - hits_before, 1U) << "the fault took effect";
    EXPECT_LE(flashed.board().core().longest_awake_ps(), 5'000 * kPsPerUs);
    EXPECT_EQ(flashed.board().reset_count(), 0U);
    EXPECT_EQ(flashed.violations(), "");
    const std::vector<Counts> after = counts_of(flashed, config.sensor_count);
    std::int64_t gap_of_bus_us = 0;
    for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
        SCOPED_TRACE(testing::Message() << "sensor " << int{sensor});
        if (config.sensors.at(sensor).bus == 0) {
            gap_of_bus_us = std::max(gap_of_bus_us, longest_gap_us(flashed, sensor, began));
            continue;
        }
        EXPECT_NEAR(after[sensor].taken - before[sensor].taken, after[sensor].made - before[sensor].made,
                    1.0);
        expect_unbroken(flashed.readings(sensor));
    }
    EXPECT_LE(gap_of_bus_us, 150'000);
    std::printf("longest turn %.0f us; on that bus nothing of a sensor for %.0f ms at most\n",
                static_cast<double>(flashed.board().core().longest_awake_ps()) * 1e-6,
                static_cast<double>(gap_of_bus_us) * 1e-3);
}

constexpr FaultCase kFaults[] = {
    {{.kind = I2cFaultKind::nack_address}},
    {{.kind = I2cFaultKind::nack_byte}},
    {{.kind = I2cFaultKind::nack_byte, .position = 1}},
    {{.kind = I2cFaultKind::nack_read}},
    {{.kind = I2cFaultKind::flip_bit, .position = 9}},
    {{.kind = I2cFaultKind::flip_written_bit, .position = 5}},
    {{.kind = I2cFaultKind::lose_write, .count = 20}},  // not every transfer writes something
    {{.kind = I2cFaultKind::read_ones}},
    {{.kind = I2cFaultKind::lose_arbitration}},
    {{.kind = I2cFaultKind::stretch}},
    {{.kind = I2cFaultKind::sda_stuck_low, .position = 5}},
};
INSTANTIATE_TEST_SUITE_P(Kinds, I2cFaultTest, testing::ValuesIn(kFaults), testing::PrintToStringParamName());

// --- a line held, a controller reset in the middle

// Nine clocks do not help: somebody holds SDA for ten seconds.
TEST(ImageI2c, sda_held_long_costs_that_bus_alone_and_it_comes_back) {
    NucleoOptions options;
    options.cycles_per_instruction = 3;
    FlashedBoard flashed(fleet(8, DistanceMode::long_range, 20, 33), options);
    flashed.run_for(1s);
    flashed.board().forget_longest_awake();
    I2cWire& wire = flashed.board().wire(0);
    const std::size_t neighbour_before = flashed.readings(1).size();
    wire.inject(
        {.kind = I2cFaultKind::sda_stuck_low, .first = wire.transfer_count() + 3, .position = 1'000'000});
    flashed.run_for(500ms);
    const std::size_t held = flashed.readings(0).size();
    flashed.run_for(9'500ms);
    EXPECT_TRUE(wire.is_sda_low(flashed.now())) << "nobody let go";
    EXPECT_EQ(flashed.readings(0).size(), held);
    EXPECT_NEAR(static_cast<double>(flashed.readings(1).size() - neighbour_before), 303.0, 5.0);
    EXPECT_LE(flashed.board().core().longest_awake_ps(), 5'000 * kPsPerUs);
    wire.clear_faults();
    wire.let_go_of_sda();
    flashed.run_for(2s);
    // Tried again every second; then both sensors of the bus start as after power-up.
    for (const std::uint8_t sensor : {std::uint8_t{0}, std::uint8_t{4}}) {
        EXPECT_GE(flashed.readings(sensor).back().end.us, flashed.now().us - 100'000) << int{sensor};
    }
    EXPECT_EQ(flashed.board().reset_count(), 0U);
    EXPECT_EQ(flashed.violations(), "");
}

// I12. Each time the controller is stopped within 50 us of some transfer's beginning or middle: of the
// bring-up, and while ranging. Behind the 74HC595, whose outputs go off, all sensors are in reset at once.
// Pins let go of their lines: who was brought up stays at its address, in the middle of a byte; who was in
// reset comes to 0x29, all at once.
class ImageI2cReset : public testing::TestWithParam<XshutWiring> {};

TEST_P(ImageI2cReset, in_the_middle_of_a_transfer_is_followed_by_a_clean_start) {
    FlashedBoard flashed(wired(fleet(4, DistanceMode::long_range, 20, 33), GetParam()));
    for (int i = 0; i < 60; ++i) {
        const I2cWire& wire = flashed.board().wire(static_cast<std::size_t>(i % 4));
        flashed.run_for(i % 2 == 0 ? Microseconds{5'000 + 503 * i} : Microseconds{250'000 + 503 * i});
        for (int turn = 0; turn < 2'000 && !wire.is_in_transfer(); ++turn) flashed.run_for(Microseconds{50});
        ASSERT_TRUE(wire.is_in_transfer()) << i;
        flashed.board().press_reset();
    }
    const std::int64_t reset_us = flashed.now().us;
    flashed.run_for(600ms);
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
        ASSERT_FALSE(flashed.readings(sensor).empty());
        EXPECT_GE(flashed.readings(sensor).back().end.us, reset_us + 500'000) << int{sensor};
    }
    EXPECT_EQ(flashed.heartbeats().back().heartbeat.state, wire::NodeState::ranging);
    EXPECT_EQ(flashed.violations(), "");
}

INSTANTIATE_TEST_SUITE_P(Wirings, ImageI2cReset,
                         testing::Values(XshutWiring::chain, XshutWiring::pins, XshutWiring::both),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace octoskin::sim::stm32
