// Ten seconds of whole fleets whose oscillators are up to 7 % off, as the parts' real ones are. Oracle: the
// simulated sensors' own windows; each range has a distance of its own by which it is found again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "hw/rigfile/i2c_load.hpp"
#include "tests/sim/capture_oracle.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::capture_error_us;
using test::fleet_config;
using test::NodeRig;
using test::SaidReading;
using test::SensorSetup;
using test::ToldBounds;
using test::TrueRange;
using test::truth_of;

constexpr Microseconds kDuration{10'000'000};
// Until then every sensor has been trimmed twice at most.
constexpr std::int64_t kSettledUs = 2'000'000;
// A range whose window ended by then has had the time to be read and sent.
constexpr std::int64_t kCompleteUs = 9'900'000;

NodeConfig at_30_hz(std::uint8_t count, std::uint8_t buses) {
    return fleet_config(count, buses);
}

NodeConfig at_50_hz(std::uint8_t count, std::uint8_t buses) {
    NodeConfig config = fleet_config(count, buses);
    for (std::uint8_t i = 0; i < count; ++i) {
        SensorConfig& sensor = config.sensors[i];
        sensor.distance_mode = DistanceMode::short_range;
        sensor.timing_budget_ms = 15;
        sensor.inter_measurement_ms = 20;
        sensor.phase_us = static_cast<std::uint16_t>(20'000 / count * i);
    }
    return config;
}

/// Real periods from 7 % below to 7 % above the nominal ones; oscillator values over all that are modelled.
std::vector<SensorSetup> spread_fleet(std::uint8_t count) {
    std::vector<SensorSetup> setups(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double period_factor = 0.93 + 0.14 * static_cast<double>(i) / (count - 1);
        setups[i].part.slow_clock_factor = 1.075 / period_factor;
        setups[i].part.osc_calibrate = static_cast<std::uint16_t>(30 + i % 16);
    }
    return setups;
}

struct Outcome {
    std::vector<std::int64_t> errors_us;  ///< absolute, of the settled part
    std::int64_t worst_error_us = 0;      ///< from the first reading on
    std::int64_t beyond_bound = 0;        ///< readings whose error exceeds the bound told for their sensor
    std::int64_t never_measured = 0;      ///< readings of a distance that no range had
    std::int64_t used = 0;
    std::int64_t lost = 0;
    std::int64_t twice = 0;
    std::int64_t first_us = 0;  ///< of the sensor that came last
};

/// Every data-ready line chatters from then on.
struct ChatterFrom {
    std::int64_t begins_us = 0;
};

class FleetRun {
  public:
    FleetRun(const NodeConfig& config, Microseconds loop = Microseconds{0})
        // The node's clock starts 5 s before it wraps and its crystal is 100 ppm off.
        : config_(config),
          rig_(config, spread_fleet(config.sensor_count), sim::NodeClock{{0xFFFFFFFFU - 5'000'000U}, 100.0}) {
        run(Microseconds{kSettledUs}, loop);
        polls_settled_ = polls();
        accepted_settled_ = rig_.node().counts().accepted;
        run(kDuration - Microseconds{kSettledUs}, loop);
        judge_all();
    }
    /// The same with parts of these traits.
    FleetRun(const NodeConfig& config, const sim::SensorTraits& traits)
        : config_(config),
          rig_(config, with_traits(spread_fleet(config.sensor_count), traits),
               sim::NodeClock{{0xFFFFFFFFU - 5'000'000U}, 100.0}) {
        run(Microseconds{kSettledUs}, Microseconds{0});
        polls_settled_ = polls();
        accepted_settled_ = rig_.node().counts().accepted;
        run(kDuration - Microseconds{kSettledUs}, Microseconds{0});
        judge_all();
    }
    FleetRun(const NodeConfig& config, ChatterFrom chatter)
        : config_(config),
          rig_(config, spread_fleet(config.sensor_count), sim::NodeClock{{0xFFFFFFFFU - 5'000'000U}, 100.0}) {
        rig_.run_for(Microseconds{chatter.begins_us});
        for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus)
            rig_.data_ready().line(bus).set_fault(sim::LineFault::chatters);
        rig_.run_for(kDuration - Microseconds{chatter.begins_us});
        judge_all();
    }
    [[nodiscard]] const Outcome& outcome() const { return outcome_; }
    [[nodiscard]] NodeRig& rig() { return rig_; }
    [[nodiscard]] double bus_use() {
        double most = 0.0;
        for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus) {
            most = std::max(most, static_cast<double>(rig_.bus(bus).busy_time().count()));
        }
        return most / static_cast<double>(kDuration.count());
    }
    /// Of the settled part.
    [[nodiscard]] double polls_per_reading() {
        const std::uint32_t accepted = rig_.node().counts().accepted - accepted_settled_;
        return static_cast<double>(polls() - polls_settled_) / accepted;
    }
    [[nodiscard]] std::int64_t error_us(double quantile) const {
        const auto last = static_cast<double>(outcome_.errors_us.size() - 1);
        return outcome_.errors_us.at(static_cast<std::size_t>(quantile * last));
    }
    void report(const std::string& name) {
        std::printf(
            "%-28s capture error p50 %lld p99 %lld max %lld us, from the first reading on %lld us; used "
            "%lld, lost %lld; I2C %.1f %%, "
            "CAN %.1f %%; last sensor's first reading %.0f ms\n",
            name.c_str(), static_cast<long long>(error_us(0.5)), static_cast<long long>(error_us(0.99)),
            static_cast<long long>(error_us(1.0)), static_cast<long long>(outcome_.worst_error_us),
            static_cast<long long>(outcome_.used), static_cast<long long>(outcome_.lost), 100.0 * bus_use(),
            100.0 * rig_.can().busy_fraction(), static_cast<double>(outcome_.first_us) * 1e-3);
    }

  private:
    static std::vector<SensorSetup> with_traits(std::vector<SensorSetup> setups,
                                                const sim::SensorTraits& traits) {
        for (SensorSetup& setup : setups) setup.part.traits = traits;
        return setups;
    }
    void run(Microseconds duration, Microseconds loop) {
        if (loop.count() > 0) {
            rig_.run_in_steps_for(duration, loop);
        } else {
            rig_.run_for(duration);
        }
    }
    [[nodiscard]] std::uint64_t polls() {
        std::uint64_t polls = 0;
        for (std::size_t sensor = 0; sensor < config_.sensor_count; ++sensor)
            polls += rig_.sensor(sensor).poll_count();
        return polls;
    }
    void judge_all() {
        const ToldBounds bounds(rig_);
        for (std::uint8_t sensor = 0; sensor < config_.sensor_count; ++sensor) judge(sensor, bounds);
        std::sort(outcome_.errors_us.begin(), outcome_.errors_us.end());
    }
    void judge(std::uint8_t sensor, const ToldBounds& bounds) {
        std::map<std::int64_t, int> uses;  // by the window's middle
        const auto readings = rig_.readings_of(sensor);
        for (const SaidReading& said : readings) {
            const TrueRange* truth = truth_of(rig_, sensor, said);
            if (truth == nullptr) {
                ++outcome_.never_measured;
                continue;
            }
            ++uses[truth->window_middle.us];
            const std::int64_t error_us = std::abs(capture_error_us(rig_, said, *truth));
            if (error_us > bounds.at(sensor, said.end)) ++outcome_.beyond_bound;
            outcome_.worst_error_us = std::max(outcome_.worst_error_us, error_us);
            if (said.end.us > kSettledUs) outcome_.errors_us.push_back(error_us);
        }
        for (const TrueRange& range : rig_.truth(sensor)) {
            const int times = uses[range.window_middle.us];
            outcome_.twice += times > 1 ? 1 : 0;
            if (range.window_middle.us < kSettledUs || range.window_middle.us > kCompleteUs) continue;
            outcome_.used += times > 0 ? 1 : 0;
            outcome_.lost += times == 0 ? 1 : 0;
        }
        outcome_.first_us =
            std::max(outcome_.first_us, readings.empty() ? kDuration.count() : readings.front().end.us);
    }
    NodeConfig config_;
    NodeRig rig_;
    Outcome outcome_;
    std::uint64_t polls_settled_ = 0;
    std::uint32_t accepted_settled_ = 0;
};

void expect_whole(FleetRun& run) {
    EXPECT_EQ(run.outcome().lost, 0);
    EXPECT_EQ(run.outcome().twice, 0);
    EXPECT_EQ(run.outcome().never_measured, 0);
    EXPECT_EQ(run.outcome().beyond_bound, 0);
    const NodeCounts counts = run.rig().node().counts();
    EXPECT_EQ(counts.rejected + counts.displaced + counts.late + counts.sensor_restarts, 0U);
    EXPECT_LE(run.outcome().first_us, 400'000);
}

void expect_trimmed(NodeRig& rig, std::uint8_t count, int tolerance_permille) {
    for (std::uint8_t sensor = 0; sensor < count; ++sensor) {
        EXPECT_LE(std::abs(rig.last_health(sensor)->period_error_permille), tolerance_permille)
            << int{sensor};
    }
}

TEST(NodeFleet, loses_no_reading_of_17_sensors_at_30_hz) {
    FleetRun run(at_30_hz(17, 4));
    run.report("17 at 30 Hz, CAN FD");
    expect_whole(run);
    expect_trimmed(run.rig(), 17, 5);
    // 17 sensors in 7.9 s at 33 ms
    EXPECT_NEAR(static_cast<double>(run.outcome().used), 17 * 7'900.0 / 33.0, 40.0);
    EXPECT_LE(run.error_us(0.5), 50);
    EXPECT_LE(run.error_us(0.99), 100);
    EXPECT_LE(run.outcome().worst_error_us, 250);
}

TEST(NodeFleet, loses_no_reading_of_17_sensors_at_50_hz) {
    FleetRun run(at_50_hz(17, 4));
    run.report("17 at 50 Hz, CAN FD");
    expect_whole(run);
    expect_trimmed(run.rig(), 17, 5);
    EXPECT_NEAR(static_cast<double>(run.outcome().used), 17 * 7'900.0 / 20.0, 80.0);
    EXPECT_LE(run.error_us(0.5), 50);
    EXPECT_LE(run.error_us(0.99), 100);
    EXPECT_LE(run.outcome().worst_error_us, 1'000);
}

NodeConfig with_data_ready_lines(NodeConfig config) {
    config.data_ready_buses = 0b1111;
    return config;
}

TEST(NodeFleet, asks_less_often_where_lines_tell_of_data_and_knows_times_no_worse) {
    for (const NodeConfig& config : {at_30_hz(17, 4), at_50_hz(17, 4), at_30_hz(34, 4)}) {
        FleetRun without(config);
        FleetRun with(with_data_ready_lines(config));
        without.report("without data-ready lines");
        with.report("with");
        std::printf("polls per reading: %.2f without, %.2f with; %u spurious falls\n",
                    without.polls_per_reading(), with.polls_per_reading(),
                    with.rig().node().counts().spurious_hints);
        expect_whole(with);
        EXPECT_EQ(with.rig().node().ignored_data_ready(), 0);
        EXPECT_LT(with.polls_per_reading(), without.polls_per_reading());
        EXPECT_LE(with.polls_per_reading(), 1.35);
        EXPECT_LE(with.bus_use(), without.bus_use());
        EXPECT_LE(with.error_us(0.5), without.error_us(0.5) + 10);
        EXPECT_LE(with.error_us(0.99), 100);
        EXPECT_LE(with.outcome().worst_error_us, 1'000);
    }
}

TEST(NodeFleet, loses_no_reading_and_tells_no_wrong_time_while_lines_chatter) {
    for (const std::int64_t begins_us : {0, 3'000'000}) {
        FleetRun run(with_data_ready_lines(at_50_hz(17, 4)), ChatterFrom{begins_us});
        run.report("lines chatter");
        expect_whole(run);
        EXPECT_EQ(run.rig().node().ignored_data_ready(), 0b1111);
    }
}

TEST(NodeFleet, loses_no_reading_in_classical_frames_at_500_kbit_per_second) {
    NodeConfig config = at_50_hz(17, 4);
    config.uses_can_fd = false;
    config.nominal_bitrate = 500'000;
    FleetRun run(config);
    run.report("17 at 50 Hz, classical");
    expect_whole(run);
}

TEST(NodeFleet, loses_no_reading_of_34_sensors_at_30_hz) {
    FleetRun run(at_30_hz(34, 4));
    run.report("34 at 30 Hz, CAN FD");
    expect_whole(run);
    EXPECT_LE(run.error_us(0.5), 50);
    EXPECT_LE(run.error_us(0.99), 100);
    EXPECT_LE(run.outcome().worst_error_us, 1'000);
    EXPECT_LE(run.bus_use(), 0.40);
}

/// As many as a rig may put there: one more and its load is above the 70 % that it is refused for.
TEST(NodeFleet, loses_no_reading_of_a_bus_that_is_as_full_as_it_may_be) {
    FleetRun run(at_30_hz(12, 1));
    run.report("12 at 30 Hz on one bus");
    expect_whole(run);
    EXPECT_LE(run.error_us(0.99), 100);
}

TEST(NodeFleet, loses_no_reading_on_the_slowest_i2c_bus) {
    NodeConfig config = at_50_hz(17, 4);
    config.i2c_hz = 283'000;
    FleetRun run(config);
    run.report("17 at 50 Hz, I2C 283 kHz");
    expect_whole(run);
    EXPECT_LE(run.bus_use(), 0.50);
}

TEST(NodeFleet, loses_no_reading_in_a_main_loop_of_a_hundred_microseconds) {
    for (const NodeConfig& config : {at_30_hz(17, 4), at_50_hz(17, 4)}) {
        FleetRun run(config, Microseconds{100});
        run.report("17, loop of 100 us");
        expect_whole(run);
    }
}

// --- parts that are not as the public documents say

NodeConfig with_jitter(NodeConfig config, std::uint16_t ready_jitter_us) {
    config.ready_jitter_us = ready_jitter_us;
    return config;
}

TEST(NodeFleet, loses_no_reading_of_ranges_that_differ_in_length_by_what_the_rig_says) {
    for (const NodeConfig& ideal : {at_30_hz(17, 4), at_50_hz(17, 4), at_30_hz(34, 4)}) {
        const NodeConfig config = with_jitter(ideal, 1'000);
        for (const sim::SensorTraits& traits :
             {sim::SensorTraits{}, sim::SensorTraits{.range_spread = Microseconds{1'000}},
              sim::SensorTraits{.range_spread = Microseconds{700}, .range_step = Microseconds{300}}}) {
            FleetRun run(config, traits);
            run.report("ranges of any length, 1 ms");
            std::printf("polls per reading %.2f, planned load of bus 0 %.1f %%\n", run.polls_per_reading(),
                        100.0 * rig::i2c_load(config, 0) * 283.0 / 400.0);
            EXPECT_EQ(run.outcome().lost, 0);
            EXPECT_EQ(run.outcome().twice, 0);
            EXPECT_EQ(run.outcome().never_measured, 0);
            EXPECT_EQ(run.outcome().beyond_bound, 0);
            EXPECT_EQ(run.rig().node().counts().rejected, 0U);
            // The rig's estimate is for the slowest clock that the bus may have; this one has its 400 kHz.
            EXPECT_LE(run.bus_use(), rig::i2c_load(config, 0) * 283.0 / 400.0);
        }
    }
}

// One register of every part: what decides the range is learnt as any other, and nobody is withheld.
TEST(NodeFleet, ranges_with_17_parts_that_read_a_register_otherwise_than_it_is_written) {
    for (const auto& misread : {sim::MisreadRegister{.index = 0x47, .value = 0x0C},
                                sim::MisreadRegister{.index = 0x7C, .value = 0x01},
                                sim::MisreadRegister{.index = 0x0B, .value = 0x80, .mask = 0x80},
                                sim::MisreadRegister{.index = 0x33, .value = 0x03}}) {
        FleetRun run(at_30_hz(17, 4), sim::SensorTraits{.misread = {misread}});
        run.report("one register reads otherwise");
        EXPECT_EQ(run.outcome().lost, 0) << misread.index;
        EXPECT_EQ(run.outcome().beyond_bound, 0) << misread.index;
        EXPECT_LE(run.outcome().first_us, 1'200'000) << misread.index;
        const NodeCounts counts = run.rig().node().counts();
        EXPECT_EQ(counts.withheld + counts.suspect + counts.rejected, 0U) << misread.index;
        EXPECT_EQ(run.rig().said_of<wire::Heartbeat>().back().degraded_sensors, 0) << misread.index;
    }
}

// The address is written once the part says that its boot is over: the register file that its boot loads then
// does not take it back.
TEST(NodeFleet, comes_up_with_parts_whose_boot_loads_all_registers_late) {
    for (const Microseconds load : {Microseconds{500}, Microseconds{3'000}, Microseconds{5'000}}) {
        FleetRun run(at_30_hz(17, 4), sim::SensorTraits{.boot_load = load});
        run.report("boots late");
        expect_whole(run);
        EXPECT_EQ(run.rig().node().counts().boots_late, 0U);
        EXPECT_EQ(run.rig().node().counts().i2c_errors, 0U);
    }
}

}  // namespace
}  // namespace octoskin::node
