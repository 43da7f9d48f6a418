// A node of four sensors on two buses, one of which is calibrated: what the tests of that share, and the
// names that all of them use.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/support/node_rig.hpp"

namespace octoskin::node::calibrations {

using test::fleet_config;
using test::NodeRig;
using test::SensorSetup;
using wire::Calibration;
using wire::CalibrationOutcome;
using wire::CalibrationQuantity;
using wire::Command;
using wire::CommandCode;
using wire::SensorState;
using enum CalibrationOutcome;

inline constexpr Microseconds kSecond{1'000'000};
inline constexpr wire::NodeId kOwnId = 5;
inline constexpr std::uint8_t kBad = 1;  ///< the sensor to be calibrated, one of four on two buses

inline sim::RangingReturn grey_target(double range_m, double signal_mcps) {
    return {.range_m = range_m, .sigma_m = 0.003, .peak_signal_mcps = signal_mcps, .ambient_mcps = 0.1};
}
inline std::vector<SensorSetup> setups_with(const sim::RangingReturn& target, double crosstalk_kcps = 0.0) {
    std::vector<SensorSetup> setups(4);
    setups[kBad].part.crosstalk_kcps = crosstalk_kcps;
    setups[kBad].target = target;
    return setups;
}
inline void command(NodeRig& rig, CommandCode code, std::uint8_t sensor, std::uint16_t argument,
                    std::uint8_t sequence = 77) {
    rig.send_from_host(Command{.code = code, .sensor = sensor, .argument = argument, .sequence = sequence},
                       kOwnId);
}
/// Each answer once, however often it was said.
inline std::vector<Calibration> answers(const NodeRig& rig) {
    std::vector<Calibration> all = rig.said_of<Calibration>();
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}
inline std::vector<CalibrationOutcome> outcomes(const NodeRig& rig) {
    std::vector<CalibrationOutcome> all;
    for (const Calibration& said : answers(rig)) all.push_back(said.outcome);
    return all;
}
inline int last_range_mm(const NodeRig& rig) {
    const auto readings = rig.readings_of(kBad);
    return readings.empty() ? -1 : readings.back().reading.range_mm;
}

}  // namespace octoskin::node::calibrations
