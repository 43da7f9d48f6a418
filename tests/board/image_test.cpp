// The flashed image and its promises: times after reset, every reading taken, data-ready lines, clocks, CAN.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "tests/board/image_fleets.hpp"

namespace octoskin::sim::stm32 {
namespace {

using namespace std::chrono_literals;

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

class ImageTest : public testing::TestWithParam<Speed> {
  protected:
    /// After three seconds to come up and to trim: two more in which nothing may be missed.
    void expect_every_reading_taken(const NodeConfig& config, double bus_share_max) {
        FlashedBoard flashed(config, options_of(GetParam()));
        flashed.run_for(3s);
        const std::vector<Counts> before = counts_of(flashed, config.sensor_count);
        std::array<std::int64_t, 4> busy{};
        for (std::size_t bus = 0; bus < 4; ++bus) busy.at(bus) = flashed.board().i2c_busy_ps(bus);
        const std::uint64_t instructions = flashed.board().core().instructions();
        const std::uint64_t cycles = flashed.board().core().cycles();
        flashed.board().forget_longest_awake();
        flashed.run_for(2s);
        const std::vector<Counts> after = counts_of(flashed, config.sensor_count);

        double readings = 0.0;
        const double periods = 2000.0 / config.sensors[0].inter_measurement_ms;
        for (std::uint8_t sensor = 0; sensor < config.sensor_count; ++sensor) {
            SCOPED_TRACE(testing::Message() << "sensor " << int{sensor});
            const double taken = after[sensor].taken - before[sensor].taken;
            const double made = after[sensor].made - before[sensor].made;
            EXPECT_NEAR(made, periods, rate_tolerance() * periods + 1) << "the sensor keeps its rate";
            EXPECT_NEAR(taken, made, 1.0) << "one may be under way at either end";
            expect_unbroken(flashed.readings(sensor));
            readings += taken;
        }
        EXPECT_EQ(flashed.violations(), "");
        const double per_reading =
            static_cast<double>(flashed.board().core().instructions() - instructions) / readings;
        std::printf(
            "%.0f readings in 2 s, %.0f instructions each, core %.1f %% busy, longest turn %.0f us; buses",
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

    /// At three cycles an instruction the core of 34 sensors is 85 % busy: ready times are seen late,
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

// --- data-ready lines

NodeConfig with_lines(NodeConfig config) {
    config.data_ready_buses = 0b1111;
    return config;
}

// A core that is 85 % busy (34 sensors, three cycles an instruction) follows hints too late to save
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

struct LineCase {
    std::string name;
    LineFault fault;
};
void PrintTo(const LineCase& tested, std::ostream* out) {
    *out << tested.name;
}
class BrokenLine : public testing::TestWithParam<LineCase> {};

TEST_P(BrokenLine, costs_no_reading_and_no_time) {
    FlashedBoard flashed(with_lines(fleet(8, DistanceMode::short_range, 15, 20)));
    flashed.run_for(1s);
    const std::size_t before = flashed.readings(0).size() + flashed.readings(1).size();
    flashed.board().data_ready(0).set_fault(GetParam().fault);
    flashed.board().forget_longest_awake();
    flashed.run_for(1s);
    // Sensor 0 is on bus 0, sensor 1 on bus 1, whose line is whole.
    EXPECT_NEAR(static_cast<double>(flashed.readings(0).size() + flashed.readings(1).size() - before), 100.0,
                4.0);
    EXPECT_LE(flashed.board().core().longest_awake_ps(), 5'000 * kPsPerUs);
    EXPECT_EQ(flashed.board().reset_count(), 0U);
    EXPECT_EQ(flashed.violations(), "");
    const bool is_noise = GetParam().fault == LineFault::chatters;
    EXPECT_EQ(flashed.board().serial_text().find("ignored: buses 1") != std::string::npos, is_noise)
        << flashed.board().serial_text();
}
INSTANTIATE_TEST_SUITE_P(Faults, BrokenLine,
                         testing::Values(LineCase{"stuck_low", LineFault::stuck_low},
                                         LineCase{"stuck_high", LineFault::stuck_high},
                                         LineCase{"chatters", LineFault::chatters}),
                         testing::PrintToStringParamName());

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
    flashed.board().can().set_link(CanLink::unacknowledged);
    flashed.run_for(5s);
    const std::size_t during = heard() - before;
    EXPECT_LE(during, 12U) << "what had begun";
    flashed.board().can().set_link(CanLink::good);
    flashed.run_for(2s);
    const std::uint32_t reported = flashed.traffic()->tx_dropped + flashed.traffic()->late_dropped;
    // 4 sensors at 30.3 Hz for 5 s, and at most 50 heartbeats, 35 pages of information and 20 of health.
    const double readings = 4 * 5 / 0.033;
    EXPECT_GE(reported, readings - 12);
    EXPECT_LE(reported, readings + 50 + 35 + 20 + 12);
    EXPECT_EQ(flashed.violations(), "");
}

}  // namespace
}  // namespace octoskin::sim::stm32
