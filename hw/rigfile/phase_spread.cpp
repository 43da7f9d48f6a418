#include "hw/rigfile/phase_spread.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

#include "hw/rigfile/i2c_load.hpp"

namespace octoskin::rig {
namespace {

constexpr double kWindowUs = 5'000.0;
constexpr double kLoadOverMeanMax = 1.5;
constexpr std::int64_t kRepeatMaxMs = 10'000;
constexpr double kFieldOfViewRad = 27.0 * std::numbers::pi / 180.0;
constexpr double kOverlapSpareUs = 1'000.0;

/// A reading occupies the bus from `begin_us` for `length_us`.
struct Turn {
    double begin_us = 0.0;
    double length_us = 0.0;
};

std::int64_t repeat_ms(const NodeConfig& node, std::uint8_t bus) {
    std::int64_t repeat = 1;
    for (std::size_t i = 0; i < node.sensor_count; ++i) {
        if (node.sensors[i].bus == bus) {
            repeat = std::lcm(repeat, std::int64_t{node.sensors[i].inter_measurement_ms});
        }
        if (repeat > kRepeatMaxMs) return kRepeatMaxMs;
    }
    return repeat;
}

/// A reading is due one budget after its sensor's start. Sensors may have different budgets.
std::vector<Turn> turns_of(const NodeConfig& node, std::uint8_t bus, double repeat_us) {
    std::vector<Turn> turns;
    for (std::size_t i = 0; i < node.sensor_count; ++i) {
        const SensorConfig& sensor = node.sensors[i];
        if (sensor.bus != bus) continue;
        const double period_us = 1'000.0 * sensor.inter_measurement_ms;
        const double length_us = 1e6 * reading_s(node, sensor);
        for (double at = sensor.phase_us + 1'000.0 * sensor.timing_budget_ms;
             at < sensor.phase_us + 1'000.0 * sensor.timing_budget_ms + repeat_us - 0.5; at += period_us) {
            turns.push_back({.begin_us = std::fmod(at, repeat_us), .length_us = length_us});
        }
    }
    return turns;
}

/// Overlap of [begin, begin + length) with [0, window), both periodic.
double overlap_us(double begin, double length, double window, double repeat) {
    double sum = 0.0;
    for (const double shift : {-repeat, 0.0, repeat}) {
        const double from = std::max(begin + shift, 0.0);
        const double to = std::min(begin + shift + length, window);
        sum += std::max(to - from, 0.0);
    }
    return sum;
}

double busy_us(const std::vector<Turn>& turns, double window_begin, double repeat_us) {
    double sum = 0.0;
    for (const Turn& turn : turns) {
        const double begin = std::fmod(turn.begin_us - window_begin + 2.0 * repeat_us, repeat_us);
        sum += overlap_us(begin, turn.length_us, kWindowUs, repeat_us);
    }
    return sum;
}

/// For two sensors on one link: whether their fields of view overlap or each is in the other's view.
bool are_in_each_others_light(const Sensor& a, const Sensor& b) {
    if (a.link != b.link) return false;
    const Eigen::Vector3d axis_a = a.T_link_sensor.linear().col(2);
    const Eigen::Vector3d axis_b = b.T_link_sensor.linear().col(2);
    const auto angle = [](const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
        return std::acos(std::clamp(u.normalized().dot(v.normalized()), -1.0, 1.0));
    };
    if (angle(axis_a, axis_b) < kFieldOfViewRad) return true;
    const Eigen::Vector3d p_a_b = b.T_link_sensor.translation() - a.T_link_sensor.translation();
    if (p_a_b.norm() == 0.0) return false;
    return angle(axis_a, p_a_b) < kFieldOfViewRad / 2.0 && angle(axis_b, -p_a_b) < kFieldOfViewRad / 2.0;
}

bool range_together(const SensorConfig& a, const SensorConfig& b) {
    if (a.inter_measurement_ms != b.inter_measurement_ms) return false;  // their phases drift
    const double period = 1'000.0 * a.inter_measurement_ms;
    const double budget_a = 1'000.0 * a.timing_budget_ms;
    const double budget_b = 1'000.0 * b.timing_budget_ms;
    const double begin = std::fmod(static_cast<double>(b.phase_us - a.phase_us) + period, period);
    const double necessary = std::max(budget_a + budget_b - period, 0.0);
    return overlap_us(begin, budget_b, budget_a, period) > necessary + kOverlapSpareUs;
}

}  // namespace

bool PhaseSpread::is_even() const {
    constexpr double kRounding = 1e-9;
    return peak <= std::max(kLoadOverMeanMax * mean, reading) + kRounding;
}

PhaseSpread phase_spread(const NodeConfig& node, std::uint8_t bus) {
    const double repeat_us = 1'000.0 * static_cast<double>(repeat_ms(node, bus));
    const std::vector<Turn> turns = turns_of(node, bus, repeat_us);
    PhaseSpread spread;
    for (const Turn& turn : turns) {
        spread.mean += turn.length_us / repeat_us;
        spread.reading = std::max(spread.reading, std::min(turn.length_us / kWindowUs, 1.0));
        // The busiest window begins at the begin of a turn or ends at the end of one.
        for (const double begin : {turn.begin_us, turn.begin_us + turn.length_us - kWindowUs}) {
            spread.peak = std::max(spread.peak, busy_us(turns, begin, repeat_us) / kWindowUs);
        }
    }
    return spread;
}

std::vector<SensorPair> pairs_ranging_together(const Node& node) {
    std::vector<SensorPair> pairs;
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        for (std::size_t j = i + 1; j < node.sensors.size(); ++j) {
            if (range_together(node.config.sensors[i], node.config.sensors[j]) &&
                are_in_each_others_light(node.sensors[i], node.sensors[j])) {
                pairs.push_back({i, j});
            }
        }
    }
    return pairs;
}

std::vector<std::vector<std::size_t>> groups_ranging_together(const Node& node) {
    std::vector<std::size_t> least(node.sensors.size());  // of each sensor's group
    std::iota(least.begin(), least.end(), std::size_t{0});
    for (const auto& [first, second] : pairs_ranging_together(node)) {
        const std::size_t into = std::min(least[first], least[second]);
        const std::size_t from = std::max(least[first], least[second]);
        std::replace(least.begin(), least.end(), from, into);
    }
    std::vector<std::vector<std::size_t>> groups;
    for (std::size_t group = 0; group < least.size(); ++group) {
        std::vector<std::size_t> members;
        for (std::size_t i = group; i < least.size(); ++i) {
            if (least[i] == group) members.push_back(i);
        }
        if (members.size() > 1) groups.push_back(std::move(members));
    }
    return groups;
}

}  // namespace octoskin::rig
