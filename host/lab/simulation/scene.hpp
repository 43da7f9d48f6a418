// The scene of a simulation or an evaluation: a scenario, and its world or a replacement.
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
    std::vector<sim::ModelMotion> motions;  ///< of models of the world; usually none
    FilePlace world_place;                  ///< the file it was read from
    SourceFile scenario_file;               ///< its CRC-32 includes the files that it extends
    SourceFile world_file;                  ///< its CRC-32 leaves out the files of meshes
};

/// Refuses a scene with moving models: a model that moves has no single place to judge a map by.
[[nodiscard]] Status<AppError> check_stands_still(const Scene& scene);

/// Reads scenario and world, and checks that they match. `world_instead`: in place of the scenario's; empty:
/// the scenario's. Under lock_reading(), if other threads may read.
[[nodiscard]] Result<Scene, AppError> read_scene(const FilePlace& scenario, const FilePlace& world_instead);

}  // namespace octoskin
