// From a world, a rig and a scenario to a recording on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/robot/given_robot.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/sim/experiment/experiment.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin {

struct SimulationRequest {
    std::filesystem::path rig;
    GivenRobot robot;
    std::filesystem::path scenario;
    std::filesystem::path world;  ///< SDF in place of the scenario's; empty: the scenario's
    std::uint64_t seed = 0;
    bool is_depth_noise_free = false;
    std::optional<sim::EmulatedBoards> emulated{};  ///< boards run the flashed image
    std::vector<sim::BoardStart> board_starts{};    ///< of boards in this process; see there
    FilePlace out{};                                ///< created if it does not exist
    /// Called with the reason if the recording does not contain its scene.
    std::function<void(const std::string& why)> on_scene_gap{};
    /// Called for each element that was skipped when the world was read.
    std::function<void(const std::string& warning)> on_world_warning{};
    bool may_replace = false;  ///< the content of `out`, if that is a simulated recording
};

/// Calls on_world_warning, if set, with each of the world's warnings.
void report_world_warnings(const SimulationRequest& request, const sim::World& world);

/// Simulates and records. On failure `out` is unchanged. The recording's rig has the seed's shift in
/// T_map_base. Several threads may each make a recording. Not to be called while another thread reads
/// a rig, world or robot, except under lock_reading().
[[nodiscard]] Result<sim::ExperimentSummary, AppError> simulate_recording(
    const SimulationRequest& request, const std::function<void(double)>& on_progress = {});

}  // namespace octoskin
