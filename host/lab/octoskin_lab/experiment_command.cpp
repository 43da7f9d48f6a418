// octoskin-lab experiment: seeds x configurations, with metrics, maps and a report. What ./demo runs.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <thread>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/interruption.hpp"
#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/lab/octoskin_lab/commands.hpp"
#include "host/lab/octoskin_lab/model_path.hpp"
#include "host/lab/study/study.hpp"

namespace octoskin::app {
namespace {

void run_experiment(const StudyRequest& request) {
    const Interruption interruption;
    const auto start = std::chrono::steady_clock::now();
    const auto results = run_study(request, [](const std::string& line) { spdlog::info("{}", line); });
    if (!results) throw CommandFailure(results.error());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print_text(evaluation::metrics_table(*results) + "\n");
    print(
        "Two ground truths: occupied to lost count voxels against the map of a noise-free camera, "
        "precision to\n"
        "brier judge by where the world's surfaces are, seen_occupied to availability by what the camera\n"
        "sees of them. docs/reference/evaluation.md has all.\n");
    print("{:.0f} s in all. Look at {}\n", seconds,
          std::filesystem::absolute(request.out / "report.html").string());
}

}  // namespace

void add_experiment_command(CLI::App& app) {
    auto request = std::make_shared<StudyRequest>();
    request->inputs.rig = shipped_file("hw/rigs/experiment.yaml");
    request->inputs.scenario = shipped_file("hw/worlds/experiment.scenario.yaml");
    request->papers_scenario = request->inputs.scenario;
    request->view_script = shipped_file("view/report_view.js");
    request->seeds = {0};
    request->configurations = {kDefaultMapping};
    request->jobs = std::max(1U, std::thread::hardware_concurrency());
    CLI::App* command = app.add_subcommand(
        "experiment", "Simulate, replay and judge over seeds; write maps, metrics and a report");
    command->add_option("--out", request->out, "Directory of the results: empty, or of an experiment before")
        ->required();
    command->add_option("--seeds", request->seeds, "Seeds; the first one's maps and recording are kept")
        ->capture_default_str()
        ->check(seed());
    command->add_option("--configurations", request->configurations)
        ->description(configuration_help("Any of"))
        ->capture_default_str();
    command->add_option("--jobs", request->jobs, "Seeds at once")
        ->capture_default_str()
        ->check(from_to(1, 64));
    command->add_option("--rig", request->inputs.rig, "Rig (YAML)")
        ->capture_default_str()
        ->check(existing_file());
    add_robot_options(*command, request->inputs.robot, "Robot (URDF) in place of the rig's");
    command->add_option("--scenario", request->inputs.scenario, "Motion, noise, seeds, judged region (YAML)")
        ->capture_default_str()
        ->check(existing_file());
    command->add_option("--world", request->inputs.world, "World (SDF) in place of the scenario's")
        ->check(existing_file());
    add_model_path(*command);
    request->inputs.on_world_warning = [](const std::string& warning) { spdlog::warn("{}", warning); };
    command->callback([request] { run_experiment(*request); });
}

}  // namespace octoskin::app
