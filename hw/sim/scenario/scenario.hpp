// What happens in a simulated world: how the arm moves, how noisy the sensors are, what the seeds change, and
// what is judged.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/arm/trajectory.hpp"
#include "hw/sim/vl53l1x/ranging_timing.hpp"

namespace octoskin::sim {

/// The optics of the simulated range sensors, where they are not the chip's own.
struct RangeOptics {
    double sigma_m = 0.0;       ///< of a sensor that sees one ray
    double min_m = 0.0;         ///< nothing nearer and
    double max_m = 0.0;         ///< nothing further is seen
    double reflectivity = 0.5;  ///< of every surface, for sensors that see a cone
};

/// The box that the evaluation judges, in the robot's base frame, metres.
struct ScenarioRegion {
    Eigen::Vector3d p_base_min = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_base_max = Eigen::Vector3d::Zero();
    std::optional<double> floor_top_m;  ///< its layer of voxels is not judged
};

/// A line of a scenario or of a file that it extends.
struct ScenarioPlace {
    std::filesystem::path file;
    int line = 0;  ///< 1-based
};

struct Scenario {
    std::filesystem::path file;             ///< that it was read from
    std::vector<FilePlace> extended_files;  ///< that this file extends
    std::string name;
    FilePlace world;  ///< absolute, or below the folder of a recording
    /// What moves in it and when (motion.hpp), as `world`; empty: nothing does.
    FilePlace world_motion;
    double rest_s = 0.0;  ///< at rest from the start of the recording to the START mark
    CircleMotion motion;
    double depth_sigma_m = 0.0;
    RangeOptics ranges;
    SlowClockSpread slow_clocks;          ///< of the sensors
    std::vector<TraitsOf> sensor_traits;  ///< likewise
    /// Translation of T_map_base, one per seed: where world, camera and robot together stand in the map's
    /// grid.
    std::vector<Eigen::Vector3d> map_shifts_m;
    double further_map_shift_max_m = 0.0;
    std::vector<std::string> hidden_models;  ///< SDF models that the camera is not supposed to see
    ScenarioRegion region;
    /// The same scenario as one file, which names its world and what moves kRecordedWorld and
    /// kRecordedMotion, beside it.
    std::string standalone_text;
    /// Where what may turn out wrong only later is written, by its key: "motion.circle.link".
    std::map<std::string, ScenarioPlace, std::less<>> places;

    /// The shift of any seed: of those listed, else uniform in [0, further_map_shift_max_m) on each axis.
    [[nodiscard]] Eigen::Vector3d map_shift_m(std::uint64_t seed) const;
    /// An error about the value of one key, at its line if that is among `places`.
    [[nodiscard]] rig::RigError error(std::string_view key, std::string what) const;
};

/// What standalone_text calls them.
inline constexpr const char* kRecordedWorld = "world.sdf";
inline constexpr const char* kRecordedMotion = "motion.yaml";

/// Whose world is used: then that of the scenario need not be there.
enum class WorldOf : std::uint8_t { scenario, others };

/// Reads and checks a scenario, as strictly as read_rig(): unknown keys, types, units, ranges; `extends:`
/// works too. Paths in it are relative to the file. A scenario below a folder that was named, a recording,
/// refers to files of that folder alone, behind no link.
[[nodiscard]] Result<Scenario, rig::RigError> read_scenario(const FilePlace& file,
                                                            WorldOf world = WorldOf::scenario);

}  // namespace octoskin::sim
