// octoskin simulate: a recording of the simulated rig.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "host/apps/octoskin/commands.hpp"
#include "host/apps/simulation/simulation.hpp"

namespace octoskin::app {
namespace {

void simulate(const SimulationRequest& request) {
    int last_percent = -10;
    const auto on_progress = [&last_percent](double fraction) {
        const int percent = static_cast<int>(fraction * 100.0);
        if (percent < last_percent + 10) return;
        last_percent = percent;
        spdlog::info("simulating: {} %", percent);
    };
    const auto summary = simulate_recording(request, on_progress);
    if (!summary) throw CommandFailure(summary.error());
    fmt::print(
        "{}: {:.1f} s, {} CAN frames, {} depth frames; first range after {:.2f} s, CAN bus {:.1f} % busy, "
        "busiest I2C bus "
        "{:.1f} %\n",
        request.out.string(), summary->duration_s, summary->can_frames, summary->depth_frames,
        summary->first_range_s, 100.0 * summary->can_busy_fraction,
        100.0 * *std::max_element(summary->i2c_busy_fraction.begin(), summary->i2c_busy_fraction.end()));
}

}  // namespace

void add_simulate_command(CLI::App& app) {
    auto request = std::make_shared<SimulationRequest>();
    request->rig = shipped_file("hw/rigs/experiment.yaml");
    request->scenario = shipped_file("hw/worlds/experiment.scenario.yaml");
    CLI::App* command =
        app.add_subcommand("simulate", "Simulate the rig down to its sensors' registers; write a recording");
    command->add_option("out", request->out, "Directory of the recording")->required();
    command->add_option("--rig", request->rig, "Rig (YAML)")->capture_default_str()->check(CLI::ExistingFile);
    command->add_option("--robot", request->robot, "Robot (URDF) in place of the rig's")
        ->check(CLI::ExistingFile);
    command->add_option("--scenario", request->scenario, "Motion, noise, seeds (YAML)")
        ->capture_default_str()
        ->check(CLI::ExistingFile);
    command->add_option("--world", request->world, "World (SDF) in place of the scenario's")
        ->check(CLI::ExistingFile);
    command
        ->add_option("--seed", request->seed,
                     "Noise, parts, clocks, and where the world stands in the map's grid")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    command->add_flag("--noise-free-depth", request->is_depth_noise_free, "A camera without noise");
    command->callback([request] { simulate(*request); });
}

}  // namespace octoskin::app
