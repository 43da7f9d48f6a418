// octoskin robot: fits capsules to the meshes of a URDF, and says how they fit.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/text_file.hpp"
#include "host/apps/robot/body_picture.hpp"
#include "host/apps/robot/robot_report.hpp"
#include "host/io/folder/confined.hpp"
#include "host/io/robot/robot_fit.hpp"

namespace octoskin::app {
namespace {

struct RobotOptions {
    std::filesystem::path urdf;
    std::string base_link;
    std::vector<PackagePath> packages;
    std::filesystem::path out;
    std::filesystem::path picture;
    bool prints_json = false;
};

void write(const std::filesystem::path& file, const std::string& text) {
    if (file.empty()) return;
    if (const auto written = write_text(file, text); !written) throw CommandFailure(written.error());
}

/// The URDF and its meshes are the only source of what is written.
void refuse_outputs_over_inputs(const RobotOptions& options, const RobotFit& robot) {
    std::vector<std::filesystem::path> taken{options.urdf};
    for (const LinkBody& link : robot.links) taken.insert(taken.end(), link.files.begin(), link.files.end());
    if (const auto checked = check_replaces_none(options.out, taken); !checked)
        throw CommandFailure(checked.error());
    if (!options.out.empty()) taken.push_back(options.out);
    if (const auto checked = check_replaces_none(options.picture, taken); !checked)
        throw CommandFailure(checked.error());
}

void run(const RobotOptions& options) {
    for (const auto& file : {options.out, options.picture}) {
        if (file.empty()) continue;
        if (const auto place = check_text_place(file); !place) throw CommandFailure(place.error());
    }
    const auto text = read_robot_text(confined_to_recording(options.urdf), options.base_link);
    if (!text) throw CommandFailure(reading_error(ExitCode::bad_config, text.error()));
    const auto robot = fit_robot(*text, mesh_search(options.packages),
                                 [](const std::string& link) { spdlog::info("fitting link {}", link); });
    if (!robot) throw CommandFailure(reading_error(ExitCode::bad_config, robot.error()));
    refuse_outputs_over_inputs(options, *robot);
    write(options.out, robot->urdf);
    write(options.picture, body_picture(*robot));
    if (options.prints_json) {
        print_json(robot_json(*robot).dump(2));
        return;
    }
    print_text(robot_text(*robot));
    if (!options.out.empty())
        print("{}: a URDF without meshes, for a rig's robot.urdf\n", options.out.string());
}

}  // namespace

void add_robot_command(CLI::App& app) {
    auto options = std::make_shared<RobotOptions>();
    CLI::App* command =
        app.add_subcommand("robot", "Fit capsules to the meshes of a robot, and say how they fit");
    command->add_option("robot", options->urdf, "Robot (URDF)")->required()->check(existing_file());
    command->add_option("--base", options->base_link, "Base link; default: the root");
    add_package_paths(*command, options->packages);
    command->add_option("--out", options->out, "Write the robot with capsules in place of meshes (URDF)");
    command->add_option("--picture", options->picture, "Write a picture of meshes and capsules (SVG)");
    command->add_flag("--json", options->prints_json, "Print JSON");
    command->callback([options] { run(*options); });
}

}  // namespace octoskin::app
