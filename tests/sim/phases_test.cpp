// A minute of whole fleets whose oscillators are up to 7 % off: do their sensors keep taking turns? Oracle:
// the simulated sensors' own windows, and the time for which the simulated buses were truly taken.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/sim/capture_oracle.hpp"
#include "tests/support/node_rig.hpp"
#include "tests/support/turns.hpp"

namespace octoskin::node {
namespace {

using test::NodeRig;
using test::SensorSetup;
using test::TrueRange;

constexpr std::int64_t kDurationUs = 60'000'000;
// By then the periods are known to a step of their registers.
constexpr std::int64_t kSettledUs = 5'000'000;
constexpr std::int64_t kFirstStartsUs = 250'000;
constexpr double kWindowUs = 5'000.0;
constexpr double kPeakOverMeanMax = 1.5;
constexpr double kOffMaxUs = 400.0;
constexpr std::int64_t kStepUs = 100;

struct Fleet {
    std::string name;
    std::uint8_t count = 0;
    DistanceMode mode = DistanceMode::long_range;
    std::uint16_t budget_ms = 20;
    std::uint16_t period_ms = 33;
    std::size_t order = 1;  ///< in which sensors get their oscillators
    /// Of a range, beyond its budget: from none to this, in another order.
    std::int64_t overhead_max_us = 0;
    [[nodiscard]] double period_us() const { return 1'000.0 * period_ms; }
    [[nodiscard]] double budget_us() const { return 1'000.0 * budget_ms; }
};

NodeConfig config_of(const Fleet& fleet, bool holds_phases) {
    NodeConfig config = test::fleet_config(fleet.count, kNodeBusesMax);
    config.holds_phases = holds_phases;
    for (std::uint8_t i = 0; i < fleet.count; ++i) {
        SensorConfig& sensor = config.sensors.at(i);
        sensor.distance_mode = fleet.mode;
        sensor.timing_budget_ms = fleet.budget_ms;
        sensor.inter_measurement_ms = fleet.period_ms;
    }
    test::spread_phases(config);
    return config;
}

/// Real periods from 7 % below to 7 % above the nominal ones; oscillator values over all that are modelled.
std::vector<SensorSetup> parts_of(const Fleet& fleet) {
    std::vector<SensorSetup> setups(fleet.count);
    for (std::size_t i = 0; i < fleet.count; ++i) {
        const auto place = static_cast<double>(i * fleet.order % fleet.count);
        setups[i].part.slow_clock_factor = 1.075 / (0.93 + 0.14 * place / (fleet.count - 1));
        setups[i].part.osc_calibrate = static_cast<std::uint16_t>(30 + i % 16);
        const auto turn = static_cast<std::int64_t>(i * (fleet.order + 2) % fleet.count);
        setups[i].part.range_overhead = Microseconds{fleet.overhead_max_us * turn / (fleet.count - 1)};
    }
    return setups;
}

class FleetMinute {
  public:
    FleetMinute(const Fleet& fleet, bool holds_phases)
        : fleet_(fleet),
          config_(config_of(fleet, holds_phases)),
          // The node's crystal is 100 ppm off, and its clock wraps after half a minute.
          rig_(config_, parts_of(fleet), sim::NodeClock{{0xFFFFFFFFU - 30'000'000U}, 100.0}) {
        for (std::int64_t us = 0; us < kDurationUs; us += kStepUs) {
            // What bring-up does in the first range, at its 100 ms, is ST's own sequence.
            if (us == kFirstStartsUs) disturbances_in_bring_up_ = disturbances();
            rig_.run_for(Microseconds{kStepUs});
            for (std::size_t bus = 0; bus < kNodeBusesMax; ++bus)
                taken_us_.at(bus).push_back(rig_.bus(bus).busy_time().count());
        }
    }
    [[nodiscard]] NodeRig& rig() { return rig_; }
    [[nodiscard]] const NodeConfig& config() const { return config_; }

    /// How far each range of a sensor was from its phase.
    [[nodiscard]] std::vector<double> offs_us(std::uint8_t sensor) const {
        // Clearing and starting takes this long, before the sensor begins to count.
        constexpr double kStartUs = 188.0;
        std::vector<double> offs;
        for (const TrueRange& range : rig_.truth(sensor)) {
            if (range.window_middle.us < kSettledUs) continue;
            const double phase_us = config_.sensors.at(sensor).phase_us + kStartUs;
            offs.push_back(
                std::remainder(node_us(range) + fleet_.budget_us() / 2 - phase_us, fleet_.period_us()));
        }
        return offs;
    }
    /// Of the ranges that the sensors would take without a pause: those that they did not.
    [[nodiscard]] double missing() const {
        double ranges = 0.0;
        for (std::uint8_t sensor = 0; sensor < fleet_.count; ++sensor)
            ranges += static_cast<double>(offs_us(sensor).size());
        return 1.0 - ranges / (fleet_.count * (kDurationUs - kSettledUs) / fleet_.period_us());
    }
    /// Ranges taken of which no reading came.
    [[nodiscard]] std::size_t unread() const {
        std::size_t unread = 0;
        for (std::uint8_t sensor = 0; sensor < fleet_.count; ++sensor) {
            std::set<std::int64_t> read;
            for (const auto& said : rig_.readings_of(sensor)) {
                if (const TrueRange* truth = test::truth_of(rig_, sensor, said))
                    read.insert(truth->window_middle.us);
            }
            for (const TrueRange& range : rig_.truth(sensor)) {
                const std::int64_t at_us = range.window_middle.us;
                const bool is_due = at_us > kSettledUs && at_us < kDurationUs - 100'000;
                unread += is_due && !read.contains(at_us) ? 1U : 0U;
            }
        }
        return unread;
    }
    /// When each range of a sensor was in its middle.
    [[nodiscard]] std::vector<double> middles_us(std::uint8_t sensor) const {
        std::vector<double> middles;
        for (const TrueRange& range : rig_.truth(sensor)) {
            if (range.window_middle.us > kSettledUs)
                middles.push_back(static_cast<double>(range.window_middle.us));
        }
        return middles;
    }
    [[nodiscard]] double planned_peak_over_mean(std::uint8_t bus) const {
        std::vector<double> all;
        double sensors = 0.0;
        for (std::uint8_t sensor = bus; sensor < fleet_.count; sensor += kNodeBusesMax) {
            const auto middles = middles_us(sensor);
            all.insert(all.end(), middles.begin(), middles.end());
            sensors += 1.0;
        }
        return test::peak_over_mean(std::move(all), sensors, fleet_.period_us());
    }
    struct TrueLoad {
        double peak_over_mean = 0.0;
        double share_above = 0.0;  ///< of the windows of 5 ms: above one and a half times the mean
    };
    /// Of all that was transferred: polls, read-backs and starts too.
    [[nodiscard]] TrueLoad true_load(std::uint8_t bus) const {
        const auto& taken = taken_us_.at(bus);
        constexpr auto kFirst = static_cast<std::size_t>(kSettledUs / kStepUs);
        constexpr auto kWidth = static_cast<std::size_t>(kWindowUs) / kStepUs;
        const double mean =
            static_cast<double>(taken.back() - taken[kFirst]) / static_cast<double>(kDurationUs - kSettledUs);
        TrueLoad load;
        for (std::size_t at = kFirst; at + kWidth < taken.size(); ++at) {
            const double over_mean = static_cast<double>(taken[at + kWidth] - taken[at]) / kWindowUs / mean;
            load.peak_over_mean = std::max(load.peak_over_mean, over_mean);
            load.share_above += over_mean > kPeakOverMeanMax ? 1.0 : 0.0;
        }
        load.share_above /= static_cast<double>(taken.size() - kWidth - kFirst);
        return load;
    }
    /// What parts were given that they must not get while they range.
    [[nodiscard]] std::uint32_t disturbances() {
        std::uint32_t disturbances = 0;
        for (std::size_t sensor = 0; sensor < fleet_.count; ++sensor)
            disturbances += rig_.sensor(sensor).disturbance_count();
        return disturbances - disturbances_in_bring_up_;
    }
    [[nodiscard]] double needless_overlap_us() const {
        std::vector<std::vector<double>> middles;
        for (std::uint8_t sensor = 0; sensor < fleet_.count; ++sensor) middles.push_back(middles_us(sensor));
        return test::worst_needless_overlap_us(config(), middles);
    }

  private:
    [[nodiscard]] double node_us(const TrueRange& range) const {
        // Without the wrap: the grid goes on over it.
        const std::uint32_t began = rig_.clock().to_node(sim::SimTime{0}).us;
        return began + static_cast<double>(rig_.clock().to_node(range.window_middle).us - began);
    }

    Fleet fleet_;
    NodeConfig config_;
    NodeRig rig_;
    std::array<std::vector<std::int64_t>, kNodeBusesMax> taken_us_;
    std::uint32_t disturbances_in_bring_up_ = 0;
};

class Phases : public testing::TestWithParam<Fleet> {};
class HeldPhases : public testing::TestWithParam<Fleet> {};

TEST_P(HeldPhases, are_held_for_a_minute) {
    const Fleet& fleet = GetParam();
    FleetMinute run(fleet, true);
    double worst_us = 0.0;
    for (std::uint8_t sensor = 0; sensor < fleet.count; ++sensor) {
        for (const double off_us : run.offs_us(sensor)) worst_us = std::max(worst_us, std::abs(off_us));
    }
    EXPECT_LE(worst_us, kOffMaxUs);
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        EXPECT_LE(run.planned_peak_over_mean(bus), kPeakOverMeanMax) << int{bus};
        const auto load = run.true_load(bus);
        std::printf(
            "%s, bus %d: busiest 5 ms %.2f of the mean as planned, %.2f with polls and read-backs; "
            "%.1f %% of all 5 ms above 1.5\n",
            fleet.name.c_str(), bus, run.planned_peak_over_mean(bus), load.peak_over_mean,
            100.0 * load.share_above);
        EXPECT_LE(load.share_above, 0.07) << int{bus};
    }
    // Each of two may be this much off its phase.
    EXPECT_LE(run.needless_overlap_us(), 2 * kOffMaxUs);
    EXPECT_EQ(run.unread(), 0U);
    EXPECT_EQ(run.disturbances(), 0U);
    EXPECT_EQ(run.rig().node().counts().rejected, 0U);
    EXPECT_LE(run.missing(), 0.03);
    std::printf("%s: at most %.0f us off, %.0f us at once beyond need; starts cost %.2f %% of the ranges\n",
                fleet.name.c_str(), worst_us, run.needless_overlap_us(), 100.0 * run.missing());
}

TEST_P(Phases, are_lost_where_nobody_holds_them) {
    const FleetMinute run(GetParam(), false);
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        EXPECT_GT(run.planned_peak_over_mean(bus), 2.0) << int{bus};
        std::printf("%s, bus %d, not held: busiest 5 ms %.2f of the mean as planned\n",
                    GetParam().name.c_str(), bus, run.planned_peak_over_mean(bus));
    }
    EXPECT_GT(run.needless_overlap_us(), 3'000.0);
    EXPECT_LE(run.missing(), 0.001);
}

const std::vector<Fleet> kFleets{{"17_at_50_hz", 17, DistanceMode::short_range, 15, 20, 7},
                                 {"17_at_50_hz_otherwise", 17, DistanceMode::short_range, 15, 20, 5},
                                 {"34_at_30_hz", 34, DistanceMode::long_range, 20, 33, 7},
                                 {"34_at_30_hz_otherwise", 34, DistanceMode::long_range, 20, 33, 11}};
// As much as the driver leaves room for.
const std::vector<Fleet> kSlowFleets{
    {"17_at_50_hz_with_overhead", 17, DistanceMode::short_range, 15, 20, 7, 4'900},
    {"34_at_30_hz_with_overhead", 34, DistanceMode::long_range, 20, 33, 7, 4'900}};
std::string name_of(const testing::TestParamInfo<Fleet>& tested) {
    return tested.param.name;
}
INSTANTIATE_TEST_SUITE_P(Fleets, Phases, testing::ValuesIn(kFleets), name_of);
INSTANTIATE_TEST_SUITE_P(Fleets, HeldPhases, testing::ValuesIn(kFleets), name_of);
INSTANTIATE_TEST_SUITE_P(SlowFleets, HeldPhases, testing::ValuesIn(kSlowFleets), name_of);

}  // namespace
}  // namespace octoskin::node
