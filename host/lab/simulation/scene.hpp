// What a simulation happens in and an evaluation judges in: a scenario, and its world or another one.
#pragma once

#include <filesystem>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/source_file.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/moving_world.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin {

struct Scene {
    sim::Scenario scenario;
    sim::World world;
    std::vector<sim::ModelMotion> motions;  ///< of models of the world's; most often none
    FilePlace world_place;                  ///< that it was read from
    SourceFile scenario_file;               ///< its CRC-32 is over the files that it extends, too
    SourceFile world_file;                  ///< its CRC-32 leaves out the files of meshes
};

/// What moves has no one place to be judged by: refuses a scene in which something does.
[[nodiscard]] Status<AppError> check_stands_still(const Scene& scene);

/// Reads both, and checks that one fits the other. `world_instead`: in place of the scenario's; empty: the
/// scenario's. Under lock_reading(), if other threads may read.
[[nodiscard]] Result<Scene, AppError> read_scene(const FilePlace& scenario, const FilePlace& world_instead);

}  // namespace octoskin
