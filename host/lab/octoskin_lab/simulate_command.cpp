// octoskin-lab simulate: a recording of the simulated rig.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/interruption.hpp"
#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/lab/octoskin_lab/commands.hpp"
#include "host/lab/octoskin_lab/model_path.hpp"
#include "host/lab/simulation/simulation.hpp"

namespace octoskin::app {
namespace {

struct SimulateOptions {
    SimulationRequest request;
    std::filesystem::path out;
    std::string board = "core";
    std::filesystem::path image;
    std::uint32_t cycles_per_instruction = 1;
    bool allows_violations = false;
};

/// octoskin_board is in the same folder as this program.
std::filesystem::path board_program() {
    std::error_code error;
    return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "octoskin_board";
}

sim::EmulatedBoards emulated_boards(const SimulateOptions& options) {
    const sim::EmulatedBoards boards{board_program(), options.image, options.cycles_per_instruction};
    if (!std::filesystem::exists(boards.program)) {
        throw CommandFailure(
            ExitCode::unavailable,
            {.code = ErrorCode::no_program,
             .what = "not found; no package contains it",
             .remedy = "in octoskin's sources: sudo apt install libunicorn-dev, then cmake --preset "
                       "host-release -DOCTOSKIN_EMULATED_BOARD=ON && cmake --build --preset host-release "
                       "--target octoskin_board",
             .file = boards.program,
             .others = "Without --board, the node core is simulated"});
    }
    if (!std::filesystem::exists(boards.image)) {
        throw CommandFailure(ExitCode::no_input,
                             {.code = ErrorCode::not_found,
                              .what = "no such image",
                              .remedy = "give one with --image: octoskin's sources build it with the preset "
                                        "firmware-release",
                              .file = boards.image});
    }
    return boards;
}

void simulate(const SimulationRequest& request, bool allows_violations) {
    const Interruption interruption;
    int last_percent = -10;
    const auto on_progress = [&last_percent](double fraction) {
        const int percent = static_cast<int>(fraction * 10.0) * 10;
        if (percent <= last_percent) return;
        last_percent = percent;
        spdlog::info("simulating: {} %", percent);
    };
    const auto summary = simulate_recording(request, on_progress);
    if (!summary) throw CommandFailure(summary.error());
    print(
        "{}: {:.1f} s, {} CAN frames, {} depth frames; first range after {:.2f} s, CAN bus {:.1f} % busy, "
        "busiest I2C bus "
        "{:.1f} %\n",
        request.out.shown().string(), summary->duration_s, summary->can_frames, summary->depth_frames,
        summary->first_range_s, 100.0 * summary->can_busy_fraction,
        100.0 * *std::max_element(summary->i2c_busy_fraction.begin(), summary->i2c_busy_fraction.end()));
    if (summary->violations.empty() || allows_violations) return;
    throw CommandFailure(
        ExitCode::failed,
        {ErrorCode::self_check, "the image breaks rules of the chip's manuals:\n" + summary->violations});
}

}  // namespace

void add_simulate_command(CLI::App& app) {
    auto options = std::make_shared<SimulateOptions>();
    SimulationRequest* request = &options->request;
    options->image = shipped_file("build/firmware-release/bin/octoskin_node_nucleo_g474re.elf");
    request->rig = shipped_file("hw/rigs/experiment.yaml");
    request->scenario = shipped_file("hw/worlds/experiment.scenario.yaml");
    CLI::App* command =
        app.add_subcommand("simulate", "Simulate the rig down to its sensors' registers; write a recording");
    command->add_option("out", options->out, "Directory of the recording")->required();
    command->add_option("--rig", request->rig, "Rig (YAML)")->capture_default_str()->check(existing_file());
    add_robot_options(*command, request->robot, "Robot (URDF) in place of the rig's");
    command->add_option("--scenario", request->scenario, "Motion, noise, seeds (YAML)")
        ->capture_default_str()
        ->check(existing_file());
    command->add_option("--world", request->world, "World (SDF) in place of the scenario's")
        ->check(existing_file());
    add_model_path(*command);
    command
        ->add_option("--seed", request->seed,
                     "Seed of noise, parts, clocks, and of the world's offset in the map's grid")
        ->capture_default_str()
        ->check(seed());
    command->add_flag(
        "--force", request->may_replace,
        "Replace the simulated recording, and the maps made of it, that the directory holds; one that "
        "is not known to be simulated is never replaced");
    command->add_flag("--noise-free-depth", request->is_depth_noise_free, "A camera without noise");
    command
        ->add_option(
            "--board", options->board,
            "What reads the sensors: the node core in this process, or the flashed image on emulated boards")
        ->capture_default_str()
        ->check(CLI::IsMember({"core", "emulated"}));
    command->add_option("--image", options->image, "ELF for the emulated boards")
        ->capture_default_str()
        ->check(existing_file());
    command
        ->add_option("--cycles-per-instruction", options->cycles_per_instruction,
                     "Core cycles per instruction of the emulated boards")
        ->capture_default_str()
        ->check(from_to(1, 20));
    command->add_flag("--allow-violations", options->allows_violations,
                      "Exit with code 0 although the image breaks rules of the chip's manuals");
    command->callback([options] {
        options->request.out = options->out;
        options->request.on_world_warning = [](const std::string& warning) { spdlog::warn("{}", warning); };
        options->request.on_scene_gap = [](const std::string& why) {
            spdlog::warn(
                "the recording does not contain its world; to evaluate it, give --scenario and "
                "--world: {}",
                why);
        };
        if (options->board == "emulated") options->request.emulated = emulated_boards(*options);
        simulate(options->request, options->allows_violations);
    });
}

}  // namespace octoskin::app
