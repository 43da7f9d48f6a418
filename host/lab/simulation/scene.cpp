#include "host/lab/simulation/scene.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/io/folder/confined.hpp"

#include "hw/sim/scenario/hidden_models.hpp"
#include "hw/sim/scenario/motion.hpp"

namespace octoskin {

Result<Scene, AppError> read_scene(const FilePlace& scenario_file, const FilePlace& world_instead) {
    const auto world_of = world_instead.empty() ? sim::WorldOf::scenario : sim::WorldOf::others;
    auto scenario = sim::read_scenario(scenario_file, world_of);
    if (!scenario) return unexpected(reading_error(ExitCode::bad_config, scenario.error()));
    const FilePlace world_file =
        confined_to_recording(world_instead.empty() ? scenario->world : world_instead);
    auto world = sim::World::read(world_file);
    if (!world) {
        const bool is_unread = world.error().code == ErrorCode::no_program;
        return unexpected(
            reading_error(is_unread ? ExitCode::unavailable : ExitCode::bad_data, world.error()));
    }
    if (const auto checked = sim::check_hidden_models(*scenario, *world); !checked) {
        Error error = checked.error();
        error.others = "The world is " + world_file.shown().string();
        return fail(ExitCode::bad_config, std::move(error));
    }
    std::vector<sim::ModelMotion> motions;
    if (!scenario->world_motion.empty()) {
        auto read = sim::read_motion(scenario->world_motion, world->solids());
        if (!read) return unexpected(reading_error(ExitCode::bad_config, read.error()));
        motions = std::move(*read);
    }
    SourceFile scenario_source = source_file(scenario_file, scenario->extended_files);
    return Scene{std::move(*scenario), std::move(*world),          std::move(motions),
                 world_file,           std::move(scenario_source), source_file(world_file)};
}

Status<AppError> check_stands_still(const Scene& scene) {
    if (scene.motions.empty()) return Done{};
    return fail(ExitCode::bad_config,
                scene.scenario.error("world_motion",
                                     {.code = ErrorCode::unsupported,
                                      .what = "a model that moves has no single place to judge a map by",
                                      .remedy = "`octoskin-lab simulate` and `octoskin replay` accept such a "
                                                "scenario, evaluate and experiment do not"}));
}

}  // namespace octoskin
