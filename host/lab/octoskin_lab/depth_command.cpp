// octoskin-lab depth: depth updates on noisy images of worlds without a robot.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/shipped_file.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/core/text/printable.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/lab/depth_study/depth_study.hpp"
#include "host/lab/octoskin_lab/commands.hpp"
#include "host/lab/octoskin_lab/model_path.hpp"

namespace octoskin::app {
namespace {

using depth_study::DepthRequest;
using depth_study::DepthScene;

struct DepthOptions {
    DepthRequest request;
    std::filesystem::path json;
    bool moves = false;
    bool shows_hand = false;
};

void study_depth(DepthOptions& options) {
    if (options.moves) options.request.scene = DepthScene::moving;
    if (options.shows_hand) options.request.scene = DepthScene::hand;
    if (!options.json.empty())
        if (const auto checked = check_text_place(options.json); !checked)
            throw CommandFailure(checked.error());
    const auto results = value_or_fail(depth_study::run_depth_study(
        options.request, [](const std::string& line) { spdlog::info("{}", line); }));
    print_text(depth_study::depth_tables(results));
    if (options.json.empty()) return;
    const auto written = write_text(options.json, printable_json(depth_study::depth_json(results)));
    if (!written) throw CommandFailure(written.error());
}

void add_inputs(CLI::App& command, DepthRequest& request) {
    command
        .add_option("scenario", request.scenarios,
                    "World, judged region, the seeds' shifts of the grid (YAML)")
        ->capture_default_str()
        ->check(existing_file());
    command.add_option("--rig", request.rig, "Rig (YAML), for its camera")
        ->capture_default_str()
        ->check(existing_file());
    command.add_option("--configurations", request.configurations)
        ->description(configuration_help("Any of"))
        ->capture_default_str();
    command.add_option("--noise", request.noises, "Noises of the camera: deviation in metres, or kinect")
        ->capture_default_str();
    command
        .add_option("--sigma-factor", request.sigma_factors,
                    "The configurations get the camera's noise times each of these")
        ->capture_default_str()
        ->check(from_to(0.1, 10.0));
    command
        .add_option("--seeds", request.seeds,
                    "Seeds of the noise and of the world's offset in the map's grid")
        ->capture_default_str()
        ->check(seed());
    command.add_option("--at", request.times_s, "Seconds after the first image at which the maps are judged")
        ->capture_default_str()
        ->check(from_to(0.0, 600.0));
}

}  // namespace

void add_depth_command(CLI::App& app) {
    auto options = std::make_shared<DepthOptions>();
    DepthRequest& request = options->request;
    request.scenarios = {shipped_file("hw/worlds/experiment.scenario.yaml")};
    request.rig = shipped_file("hw/rigs/experiment.yaml");
    request.configurations = {kDefaultMapping};
    request.noises = {"0.03"};
    request.seeds = {0};
    request.times_s = {0.3, 1.0, 5.0};
    request.jobs = std::max(1U, std::thread::hardware_concurrency());
    CLI::App* command = app.add_subcommand(
        "depth", "Judge how noisy depth images become a map, in worlds without a robot; no recording");
    add_inputs(*command, request);
    auto* moving =
        command->add_flag("--moving", options->moves,
                          "The camera moves on a circle; judged at the first image and at the last of --at");
    command
        ->add_flag("--hand", options->shows_hand,
                   "Instead: a small box that appears, approaches or passes at 2 to 20 cm/s, and leaves")
        ->excludes(moving);
    command->add_option("--json", options->json, "Write the figures of each seed to this file too");
    command->add_option("--jobs", request.jobs, "Cases at once")
        ->capture_default_str()
        ->check(from_to(1, 64));
    add_model_path(*command);
    request.on_world_warning = [](const std::string& warning) { spdlog::warn("{}", warning); };
    command->callback([options] { study_depth(*options); });
}

}  // namespace octoskin::app
