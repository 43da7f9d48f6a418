// The flashed image and its promises (docs, reliability): times after reset, every reading taken, and the
// main loop's length whatever a bus does.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "tests/board/flashed_board.hpp"
#include "tests/support/turns.hpp"

namespace octoskin::sim::stm32 {
namespace {

using namespace std::chrono_literals;

NodeConfig seventeen_at_50_hz() {
    return fleet(17, DistanceMode::short_range, 15, 20);
}
NodeConfig thirty_four_at_30_hz() {
    return fleet(34, DistanceMode::long_range, 20, 33);
}

/// An instruction costs one cycle or three; I2C edges are typical or as slow as the specification allows.
struct Speed {
    std::uint32_t cycles_per_instruction;
    BusEdges edges;
};
void PrintTo(const Speed& speed, std::ostream* out) {
    *out << speed.cycles_per_instruction
         << (speed.edges == BusEdges::slowest ? "_slow_edges" : "_typical_edges");
}
NucleoOptions options_of(const Speed& speed) {
    NucleoOptions options;
    options.cycles_per_instruction = speed.cycles_per_instruction;
    options.edges = speed.edges;
    return options;
}

/// What a second costs, after two to come up and to trim.
struct PollsAndReadings {
    double polls = 0.0;
    double readings = 0.0;
    double core_percent = 0.0;
    [[nodiscard]] double polls_per_reading() const { return polls / readings; }
};

PollsAndReadings cost_of_a_second(const NodeConfig& config) {
    FlashedBoard flashed(config);
    const auto so_far = [&] {
        PollsAndReadings sum;
        sum.core_percent = static_cast<double>(flashed.board().core().cycles()) / 1.6e6;
        for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
            sum.polls += static_cast<double>(flashed.sensor(sensor).poll_count());
            sum.readings += static_cast<double>(flashed.readings(sensor).size());
        }
        return sum;
    };
    flashed.run_for(2s);
    const PollsAndReadings before = so_far();
    flashed.run_for(1s);
    const PollsAndReadings after = so_far();
    EXPECT_EQ(flashed.violations(), "");
    return {after.polls - before.polls, after.readings - before.readings,
            after.core_percent - before.core_percent};
}

void expect_unbroken(const std::vector<SaidReading>& readings) {
    for (std::size_t i = 1; i < readings.size(); ++i) {
        ASSERT_EQ(readings[i].reading.sequence,
                  (readings[i - 1].reading.sequence + 1) % wire::kSequenceCount);
        ASSERT_NE(readings[i].reading.range_mm, readings[i - 1].reading.range_mm) << "a value said twice";
    }
}

class ImageTest : public testing::TestWithParam<Speed> {
  protected:
    /// After three seconds to come up and to trim: two more in which nothing may be missed.
    void expect_every_reading_taken(const NodeConfig& config, double bus_share_max) {
        FlashedBoard flashed(config, options_of(GetParam()));
        flashed.run_for(3s);
        const auto counts = [&] {
            std::vector<std::pair<std::size_t, std::uint32_t>> all;
            for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor)
                all.emplace_back(flashed.readings(sensor).size(), flashed.rangings(sensor));
            return all;
        };
        const auto before = counts();
        std::array<std::int64_t, 4> busy{};
        for (std::size_t bus = 0; bus < 4; ++bus) busy.at(bus) = flashed.board().i2c_busy_ps(bus);
        const std::uint64_t instructions = flashed.board().core().instructions();
        const std::uint64_t cycles = flashed.board().core().cycles();
        flashed.board().forget_longest_awake();
        flashed.run_for(2s);
        const auto after = counts();

        std::size_t readings = 0;
        const double periods = 2000.0 / config.sensors[0].inter_measurement_ms;
        for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
            SCOPED_TRACE(testing::Message() << "sensor " << int{sensor});
            const auto taken = static_cast<double>(after[sensor].first - before[sensor].first);
            const auto made = static_cast<double>(after[sensor].second - before[sensor].second);
            EXPECT_NEAR(made, periods, rate_tolerance() * periods + 1) << "the sensor keeps its rate";
            EXPECT_NEAR(taken, made, 1.0) << "one may be under way at either end";
            expect_unbroken(flashed.readings(sensor));
            readings += after[sensor].first - before[sensor].first;
        }
        EXPECT_EQ(flashed.violations(), "");
        const double per_reading = static_cast<double>(flashed.board().core().instructions() - instructions) /
                                   static_cast<double>(readings);
        std::printf(
            "%zu readings in 2 s, %.0f instructions each, core %.1f %% busy, longest turn %.0f us; buses",
            readings, per_reading, static_cast<double>(flashed.board().core().cycles() - cycles) / 3.2e6,
            static_cast<double>(flashed.board().core().longest_awake_ps()) * 1e-6);
        for (std::size_t bus = 0; bus < 4; ++bus) {
            const double share =
                static_cast<double>(flashed.board().i2c_busy_ps(bus) - busy.at(bus)) * 0.5e-12;
            std::printf(" %.1f %%", 100.0 * share);
            EXPECT_LT(share, bus_share_max) << "bus " << bus;
        }
        std::printf("\n");
        EXPECT_LE(flashed.board().core().longest_awake_ps(), 5'000 * kPsPerUs);
    }

    /// At three cycles an instruction the core of 34 sensors is nine tenths busy: ready times are seen late,
    /// and a sensor's period may stay a few per cent off until its next trim. Its readings are all taken
    /// nevertheless.
    static double rate_tolerance() { return GetParam().cycles_per_instruction == 1 ? 0.02 : 0.05; }
};

TEST_P(ImageTest, seventeen_sensors_at_50_hz_on_four_buses_lose_nothing) {
    expect_every_reading_taken(seventeen_at_50_hz(), 0.50);
}

TEST_P(ImageTest, thirty_four_sensors_at_30_hz_on_four_buses_lose_nothing) {
    expect_every_reading_taken(thirty_four_at_30_hz(), 0.60);
}

TEST_P(ImageTest, heartbeat_and_ranges_come_in_time_after_reset) {
    FlashedBoard flashed(thirty_four_at_30_hz(), options_of(GetParam()));
    flashed.run_for(4s);
    const auto& beats = flashed.heartbeats();
    ASSERT_GE(beats.size(), 35U);
    EXPECT_LE(beats.front().end.us, 300'000);
    EXPECT_EQ(beats.front().heartbeat.reset_cause, wire::ResetCause::power_on);
    EXPECT_GT(flashed.first_range().us, 0);
    EXPECT_LE(flashed.first_range().us, 2'000'000);
    for (std::uint8_t sensor = 0; sensor < 34; ++sensor) {
        ASSERT_FALSE(flashed.readings(sensor).empty()) << int{sensor};
        EXPECT_LE(flashed.readings(sensor).front().end.us, 2'000'000) << int{sensor};
    }
    std::int64_t jitter_max_us = 0;
    for (std::size_t i = 1; i < beats.size(); ++i) {
        const std::int64_t interval = beats[i].end.us - beats[i - 1].end.us;
        jitter_max_us = std::max(jitter_max_us, std::abs(interval - 100'000));
    }
    EXPECT_LE(jitter_max_us, 10'000);
    std::printf("first heartbeat after %.1f ms, first range after %.1f ms, jitter %.2f ms\n",
                static_cast<double>(beats.front().end.us) * 1e-3,
                static_cast<double>(flashed.first_range().us) * 1e-3,
                static_cast<double>(jitter_max_us) * 1e-3);
    EXPECT_EQ(flashed.violations(), "");
}

INSTANTIATE_TEST_SUITE_P(Speeds, ImageTest,
                         testing::Values(Speed{1, BusEdges::typical}, Speed{3, BusEdges::slowest}),
                         testing::PrintToStringParamName());

// --- phases

/// A quarter of a minute, the last ten seconds of it judged: tests/sim/phases_test has whole minutes.
struct HeldFleet {
    std::string name;
    NodeConfig config;
    Speed speed;
    double peak_over_mean_max = 0.0;
    double off_max_us = 0.0;  ///< of its phase
};
class ImagePhases : public testing::TestWithParam<HeldFleet> {};

TEST_P(ImagePhases, sensors_keep_taking_turns_where_the_rig_asks_for_it) {
    constexpr SimTime kSettled{5'000'000};
    NodeConfig config = GetParam().config;
    config.holds_phases = true;
    test::spread_phases(config);
    const double period_us = 1'000.0 * config.sensors[0].inter_measurement_ms;
    FlashedBoard flashed(config, options_of(GetParam().speed));
    flashed.run_for(15s);
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
    for (const auto& ready_us : of_bus_us) peak = std::max(peak, test::peak_over_mean(ready_us));
    EXPECT_LE(peak, GetParam().peak_over_mean_max);
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
// slow as the specification allows.
INSTANTIATE_TEST_SUITE_P(
    Fleets, ImagePhases,
    testing::Values(HeldFleet{"34_at_30_hz", thirty_four_at_30_hz(), {1, BusEdges::typical}, 1.5, 400.0},
                    HeldFleet{"17_at_50_hz", seventeen_at_50_hz(), {1, BusEdges::typical}, 1.5, 400.0},
                    HeldFleet{
                        "17_at_50_hz_slow_edges", seventeen_at_50_hz(), {3, BusEdges::slowest}, 1.6, 550.0}),
    [](const auto& tested) { return tested.param.name; });

// --- one fault on one bus

class I2cFaultTest : public testing::TestWithParam<I2cFault> {};

TEST_P(I2cFaultTest, keeps_the_loop_short_and_the_others_ranging) {
    const NodeConfig config = fleet(8, DistanceMode::long_range, 20, 33);
    NucleoOptions options;
    options.cycles_per_instruction = 3;
    FlashedBoard flashed(config, options);
    flashed.run_for(1s);
    flashed.board().forget_longest_awake();
    const std::size_t neighbour_before = flashed.readings(1).size();
    const std::int64_t began_us = flashed.now().us;
    I2cFault fault = GetParam();
    const std::uint64_t hits_before = flashed.board().wire(0).fault_hits();
    // A poll is too short for some: then another transfer.
    for (int attempt = 0; attempt < 20 && flashed.board().wire(0).fault_hits() == hits_before; ++attempt) {
        fault.first = flashed.board().wire(0).transfer_count() + 3;
        flashed.board().wire(0).inject(fault);
        flashed.run_for(100ms);
    }
    flashed.run_for(3s);

    EXPECT_GE(flashed.board().wire(0).fault_hits() - hits_before, 1U) << "the fault took effect";
    EXPECT_LE(flashed.board().core().longest_awake_ps(), 5'000 * kPsPerUs);
    EXPECT_EQ(flashed.board().reset_count(), 0U);
    EXPECT_EQ(flashed.violations(), "");
    // Sensor 1 is on another bus.
    const auto due = static_cast<double>(flashed.now().us - began_us) / 33'000.0;
    EXPECT_NEAR(static_cast<double>(flashed.readings(1).size() - neighbour_before), due, 3.0);
    // And the bus itself is back: its sensor's last reading is no older than three periods.
    ASSERT_FALSE(flashed.readings(0).empty());
    EXPECT_GE(flashed.readings(0).back().end.us, flashed.now().us - 100'000);
}

std::string name_of_fault(const testing::TestParamInfo<I2cFault>& tested) {
    constexpr const char* kNames[] = {
        "nack_address", "nack_byte",        "nack_read", "flip_bit",      "flip_written_bit", "lose_write",
        "read_ones",    "lose_arbitration", "stretch",   "sda_stuck_low", "redirect_write"};
    return std::string(kNames[static_cast<std::size_t>(tested.param.kind)]) + "_at_" +
           std::to_string(tested.param.position);
}

constexpr I2cFault kFaults[] = {
    {.kind = I2cFaultKind::nack_address},
    {.kind = I2cFaultKind::nack_byte},
    {.kind = I2cFaultKind::nack_byte, .position = 1},
    {.kind = I2cFaultKind::nack_read},
    {.kind = I2cFaultKind::flip_bit, .position = 9},
    {.kind = I2cFaultKind::flip_written_bit, .position = 5},
    {.kind = I2cFaultKind::lose_write, .count = 20},  // not every transfer writes something
    {.kind = I2cFaultKind::read_ones},
    {.kind = I2cFaultKind::lose_arbitration},
    {.kind = I2cFaultKind::stretch},
    {.kind = I2cFaultKind::sda_stuck_low, .position = 5},
};
INSTANTIATE_TEST_SUITE_P(Kinds, I2cFaultTest, testing::ValuesIn(kFaults), name_of_fault);

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

// I12: the 74HC595 keep their levels, so that sensors stay at their addresses, in the middle of a byte. Each
// time the controller is stopped within 50 us of some transfer's beginning or middle: of the bring-up, and
// while ranging.
TEST(ImageI2c, a_reset_in_the_middle_of_a_transfer_is_followed_by_a_clean_start) {
    FlashedBoard flashed(fleet(4, DistanceMode::long_range, 20, 33));
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

// --- data-ready lines

NodeConfig with_lines(NodeConfig config) {
    config.data_ready_buses = 0b1111;
    return config;
}

// A core that is nine tenths busy (34 sensors, three cycles an instruction) follows hints too late to save
// anything: 1.9 polls a reading either way.
TEST(ImageDataReady, lines_save_polls_at_full_rate) {
    const PollsAndReadings without = cost_of_a_second(seventeen_at_50_hz());
    const PollsAndReadings with = cost_of_a_second(with_lines(seventeen_at_50_hz()));
    std::printf("%.2f polls a reading without lines, %.2f with; core %.1f %%, %.1f %%\n",
                without.polls_per_reading(), with.polls_per_reading(), without.core_percent,
                with.core_percent);
    EXPECT_NEAR(with.readings, without.readings, 0.03 * without.readings);
    EXPECT_LT(with.polls_per_reading(), without.polls_per_reading());
    EXPECT_LE(with.polls_per_reading(), 1.3);
}

class BrokenLine : public testing::TestWithParam<LineFault> {};

TEST_P(BrokenLine, costs_no_reading_and_no_time) {
    FlashedBoard flashed(with_lines(fleet(8, DistanceMode::short_range, 15, 20)));
    flashed.run_for(1s);
    const std::size_t before = flashed.readings(0).size() + flashed.readings(1).size();
    flashed.board().data_ready(0).set_fault(GetParam());
    flashed.board().forget_longest_awake();
    flashed.run_for(1s);
    // Sensor 0 is on bus 0, sensor 1 on bus 1, whose line is whole.
    EXPECT_NEAR(static_cast<double>(flashed.readings(0).size() + flashed.readings(1).size() - before), 100.0,
                4.0);
    EXPECT_LE(flashed.board().core().longest_awake_ps(), 5'000 * kPsPerUs);
    EXPECT_EQ(flashed.board().reset_count(), 0U);
    EXPECT_EQ(flashed.violations(), "");
    const bool is_noise = GetParam() == LineFault::chatters;
    EXPECT_EQ(flashed.board().serial_text().find("ignored: buses 1") != std::string::npos, is_noise)
        << flashed.board().serial_text();
}
std::string name_of_line_fault(const testing::TestParamInfo<LineFault>& tested) {
    constexpr const char* kNames[] = {"none", "stuck_low", "stuck_high", "chatters"};
    return kNames[static_cast<std::size_t>(tested.param)];
}
INSTANTIATE_TEST_SUITE_P(Faults, BrokenLine,
                         testing::Values(LineFault::stuck_low, LineFault::stuck_high, LineFault::chatters),
                         name_of_line_fault);

// --- clocks

TEST(ImageCrystal, without_it_the_node_says_so_on_the_serial_line_and_is_silent_on_can) {
    NucleoOptions options;
    options.crystal.is_present = false;
    FlashedBoard flashed(fleet(4, DistanceMode::long_range, 20, 33), options);
    flashed.run_for(500ms);
    EXPECT_THAT(flashed.board().serial_text(), testing::HasSubstr("without the crystal"));
    EXPECT_TRUE(flashed.heartbeats().empty());
    EXPECT_EQ(flashed.violations(), "");
}

TEST(ImageCrystal, failing_while_it_runs_resets_the_node_into_silence) {
    NucleoOptions options;
    options.crystal.fails_at = BoardTime{700'000 * kPsPerUs};
    FlashedBoard flashed(fleet(4, DistanceMode::long_range, 20, 33), options);
    flashed.run_for(2s);
    ASSERT_FALSE(flashed.heartbeats().empty());
    EXPECT_LE(flashed.heartbeats().back().end.us, 700'500);
    EXPECT_EQ(flashed.board().reset_count(), 1U);
    EXPECT_THAT(flashed.board().serial_text(), testing::HasSubstr("without the crystal"));
    EXPECT_EQ(flashed.violations(), "");
}

// --- CAN

TEST(ImageCan, comes_back_within_a_second_after_bus_off) {
    FlashedBoard flashed(fleet(4, DistanceMode::long_range, 20, 33));
    flashed.run_for(1s);
    flashed.board().can().set_link(CanLink::broken);
    flashed.run_for(1s);
    EXPECT_LE(flashed.heartbeats().back().end.us, 1'000'500);
    flashed.board().can().set_link(CanLink::good);
    flashed.run_for(2s);
    const auto again = std::ranges::find_if(
        flashed.heartbeats(), [](const SaidHeartbeat& beat) { return beat.end.us > 2'000'000; });
    ASSERT_NE(again, flashed.heartbeats().end());
    EXPECT_LE(again->end.us, 3'000'000);
    EXPECT_EQ(flashed.violations(), "");
}

// The controller takes frames and takes them back: each reading of them is told as dropped. What the host is
// told, as sent and as dropped, is all that the sensors measured.
TEST(ImageCan, tells_every_reading_that_nobody_acknowledged) {
    FlashedBoard flashed(fleet(4, DistanceMode::long_range, 20, 33));
    flashed.run_for(2s);
    ASSERT_TRUE(flashed.traffic());
    EXPECT_EQ(flashed.traffic()->tx_dropped, 0);
    const auto heard = [&] {
        std::size_t count = 0;
        for (std::uint8_t sensor = 0; sensor < 4; ++sensor) count += flashed.readings(sensor).size();
        return count;
    };
    const std::size_t before = heard();
    flashed.board().can().set_link(CanLink::nobody_acknowledges);
    flashed.run_for(5s);
    const std::size_t during = heard() - before;
    EXPECT_LE(during, 12U) << "what had begun";
    flashed.board().can().set_link(CanLink::good);
    flashed.run_for(2s);
    const std::uint32_t told = flashed.traffic()->tx_dropped + flashed.traffic()->late_dropped;
    // 4 sensors at 30.3 Hz for 5 s, and at most 50 heartbeats, 35 pages of information and 20 of health.
    const double readings = 4 * 5 / 0.033;
    EXPECT_GE(told, readings - 12);
    EXPECT_LE(told, readings + 50 + 35 + 20 + 12);
    EXPECT_EQ(flashed.violations(), "");
}

}  // namespace
}  // namespace octoskin::sim::stm32
