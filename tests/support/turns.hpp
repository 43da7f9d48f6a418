// Checks by the true times of ranging that the sensors of a bus, and those that face each other, range in
// turn.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/config/node_config.hpp"

namespace octoskin::test {

/// Of sensors with one period on `kNodeBusesMax` buses in turn: those of a bus take turns within the period,
/// and the buses within a turn.
inline void spread_phases(NodeConfig& config) {
    constexpr double kBuses = kNodeBusesMax;
    for (std::uint8_t i = 0; i < config.sensor_count; ++i) {
        SensorConfig& sensor = config.sensors.at(i);
        const double of_bus = std::ceil((config.sensor_count - sensor.bus) / kBuses);
        const double turn = std::floor(i / kBuses) + sensor.bus / kBuses;
        sensor.phase_us = static_cast<std::uint16_t>(turn * 1'000.0 * sensor.inter_measurement_ms / of_bus);
    }
}

/// The load of a bus in its busiest 5 ms over the mean that it was planned for (a range that is given up is
/// no load), if each reading takes the bus equally long from when its data is ready: 518 bits at the slowest
/// clock that filters may make of 400 kHz, as the rig's own check has it. `ready_us`: when, of all `sensors`
/// of the bus, in any order. O(n log n).
inline double peak_over_mean(std::vector<double> ready_us, double sensors, double period_us) {
    constexpr double kWindowUs = 5'000.0;
    constexpr double kReadingUs = 518.0 * 1e6 / 283'000.0;
    constexpr std::size_t kReadingsOfWindow = 16;  // and of the reading before it, more than there can be
    std::sort(ready_us.begin(), ready_us.end());
    double busiest_us = 0.0;
    for (std::size_t first = 0; first < ready_us.size(); ++first) {
        // The busiest window begins with a reading or ends with one.
        for (const double from : {ready_us[first], ready_us[first] + kReadingUs - kWindowUs}) {
            double busy_us = 0.0;
            for (std::size_t i = first - std::min(first, kReadingsOfWindow); i < ready_us.size(); ++i) {
                if (ready_us[i] >= from + kWindowUs) break;
                const double end = std::min(ready_us[i] + kReadingUs, from + kWindowUs);
                busy_us += std::max(0.0, end - std::max(ready_us[i], from));
            }
            busiest_us = std::max(busiest_us, busy_us);
        }
    }
    return busiest_us / kWindowUs / (sensors * kReadingUs / period_us);
}

/// The longest time that two sensors range at once, from one window of each. `a_us`, `b_us`: the middles of
/// their windows, rising.
inline double longest_overlap_us(const std::vector<double>& a_us, const std::vector<double>& b_us,
                                 double window_us) {
    double longest_us = 0.0;
    for (const double middle : a_us) {
        const auto next = std::lower_bound(b_us.begin(), b_us.end(), middle);
        if (next != b_us.end()) longest_us = std::max(longest_us, window_us - (*next - middle));
        if (next != b_us.begin()) longest_us = std::max(longest_us, window_us - (middle - *(next - 1)));
    }
    return longest_us;
}

/// The greatest deviation of a sensor from its phase, with all phases relative to the common instant that
/// fits the ranges best. `middles_us`: of each sensor's windows; `phases_us`: the phases to keep.
inline double worst_off_us(const std::vector<std::vector<double>>& middles_us,
                           const std::vector<double>& phases_us, double period_us) {
    std::vector<double> offs_us;
    for (std::size_t sensor = 0; sensor < middles_us.size(); ++sensor) {
        for (const double middle : middles_us[sensor])
            offs_us.push_back(
                std::remainder(middle - phases_us[sensor] - middles_us.front().front(), period_us));
    }
    const auto middle = offs_us.begin() + static_cast<std::ptrdiff_t>(offs_us.size() / 2);
    std::nth_element(offs_us.begin(), middle, offs_us.end());
    const double median_us = *middle;
    double worst_us = 0.0;
    for (const double off_us : offs_us)
        worst_us = std::max(worst_us, std::abs(std::remainder(off_us - median_us, period_us)));
    return worst_us;
}

/// Whether two sensors are meant to range in turn: half a period apart, to 1.5 ms.
inline bool are_opposite(const SensorConfig& a, const SensorConfig& b) {
    const double apart_us = static_cast<double>(a.phase_us) - b.phase_us;
    return std::abs(apart_us - 500.0 * a.inter_measurement_ms) <= 1'500.0;
}

/// The greatest overlap of two sensors that are meant to range in turn, beyond the overlap by their phases.
/// `middles_us`: of each sensor's windows.
inline double worst_needless_overlap_us(const NodeConfig& config,
                                        const std::vector<std::vector<double>>& middles_us) {
    const double window_us = 1'000.0 * config.sensors[0].timing_budget_ms;
    const double period_us = 1'000.0 * config.sensors[0].inter_measurement_ms;
    double worst_us = -window_us;
    for (std::size_t a = 0; a < config.sensor_count; ++a) {
        for (std::size_t b = 0; b < config.sensor_count; ++b) {
            const SensorConfig& one = config.sensors.at(a);
            const SensorConfig& other = config.sensors.at(b);
            if (!are_opposite(one, other)) continue;
            const double apart_us = static_cast<double>(one.phase_us) - other.phase_us;
            const double planned_us = std::max(0.0, window_us - std::min(apart_us, period_us - apart_us));
            const double longest_us = longest_overlap_us(middles_us.at(a), middles_us.at(b), window_us);
            worst_us = std::max(worst_us, longest_us - planned_us);
        }
    }
    return worst_us;
}

}  // namespace octoskin::test
