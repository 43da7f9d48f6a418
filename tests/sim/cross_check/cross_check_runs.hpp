// Worlds of thin things near the arm, and what the comparison with the camera names in them: sensors, the
// camera, joints. Limits are chosen in some of them and judged in others.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/core/cross_check/cross_check.hpp"
#include "tests/sim/cross_check/recorded_arm.hpp"

namespace octoskin::testing_support {

struct Place {
    const char* world;
    const char* scenario;
    const char* rig;  ///< and its _cone and _zones
    Eigen::Vector3d camera_at_m;
    Eigen::Vector3d camera_looks_at_m;
};

/// Those that judge; with OCTOSKIN_CROSS_CHECK_WORLDS=tuning those in which limits were chosen.
[[nodiscard]] const std::vector<Place>& places();
/// OCTOSKIN_CROSS_CHECK_SEEDS; 0: the few of every day.
[[nodiscard]] std::uint64_t seeds();
[[nodiscard]] std::vector<std::string> rigs_of(const Place& place);
[[nodiscard]] KeptChoice choice_of(const Place& place, std::uint64_t seed);

/// What a sensor reports with an image in place of a range.
using Altered = std::function<double(SensorNumber, double range_m)>;

struct Outcome {
    std::vector<std::string> named;  ///< sensors, each once
    std::vector<std::size_t> numbers;
    std::optional<double> fault_named_s;   ///< of the camera, of a joint, or of one of the two
    std::optional<double> camera_named_s;  ///< alone
    std::optional<double> joint_named_s;   ///< alone
    std::set<std::size_t> joints;          ///< that were named, alone or beside the camera
    std::optional<PoseFault> fault_at_the_end;
    double camera_evidence_max = 0.0;
    double joint_evidence_max = 0.0;
    double evidence_max = 0.0;
    std::uint64_t compared = 0;
    std::size_t cannot_tell = 0;                ///< in the end
    std::vector<CrossCheckFinding> at_the_end;  ///< by number
};

[[nodiscard]] Outcome outcome_of(const KeptRun& run, const Altered& altered = {});
void print(const std::string& what, const Outcome& outcome);

}  // namespace octoskin::testing_support
