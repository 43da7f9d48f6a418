// A scenario: motion of the arm, noise of the sensors, effect of the seeds, and the judged region.
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
#include "hw/sim/camera/depth_noise.hpp"
#include "hw/sim/vl53l1x/ranging_timing.hpp"

namespace octoskin::sim {

/// The optics of the simulated range sensors, except the properties of the chip.
struct RangeOptics {
    double sigma_m = 0.0;       ///< of a sensor that is one ideal ray
    double min_m = 0.0;         ///< nothing nearer is seen
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
    std::filesystem::path file;             ///< the file it was read from
    std::vector<FilePlace> extended_files;  ///< that this file extends
    std::string name;
    FilePlace world;  ///< absolute, or below the folder of a recording
    /// What moves in it and when (motion.hpp), as `world`; empty: nothing does.
    FilePlace world_motion;
    double rest_s = 0.0;  ///< at rest from the start of the recording to the START mark
    CircleMotion motion;
    DepthNoise depth_noise;
    RangeOptics ranges;
    SlowClockSpread slow_clocks;          ///< of the sensors
    std::vector<TraitsOf> sensor_traits;  ///< likewise
    /// Translation of T_map_base, one per seed: the offset of world, camera and robot in the map's grid.
    std::vector<Eigen::Vector3d> map_shifts_m;
    double further_map_shift_max_m = 0.0;
    std::vector<std::string> hidden_models;  ///< SDF models that are hidden from the camera
    ScenarioRegion region;
    /// The same scenario as one file, which names its world kRecordedWorld and its motion file
    /// kRecordedMotion, both beside it.
    std::string standalone_text;
    /// Places of values that are checked only later, by key: "motion.circle.link".
    std::map<std::string, ScenarioPlace, std::less<>> places;

    /// The shift of a seed: the listed one, else uniform in [0, further_map_shift_max_m) on each axis.
    [[nodiscard]] Eigen::Vector3d map_shift_m(std::uint64_t seed) const;
    /// An error about the value of one key, at its line if that is among `places`.
    [[nodiscard]] Error error(std::string_view key, Error error) const;
};

/// The names in standalone_text.
inline constexpr const char* kRecordedWorld = "world.sdf";
inline constexpr const char* kRecordedMotion = "motion.yaml";

/// Which world is used. With `others`, the scenario's world file need not exist.
enum class WorldOf : std::uint8_t { scenario, others };

/// Reads and checks a scenario, as strictly as read_rig(): unknown keys, types, units, ranges; `extends:`
/// works too. Paths in it are relative to the file. A scenario below a named folder (a recording) may refer
/// only to files of that folder, without links.
[[nodiscard]] Result<Scenario, Error> read_scenario(const FilePlace& file, WorldOf world = WorldOf::scenario);

}  // namespace octoskin::sim
