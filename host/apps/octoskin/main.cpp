// octoskin: the one command-line program.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <sstream>

#include "host/apps/octoskin/arguments.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/standard_output.hpp"
#include "host/apps/version/version.hpp"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 done, with a bad result; 2 done, and nobody knows (query); 64 command line;\n"
    "65 unusable data;\n"
    "66 no such file; 69 a program or device is missing; 70 a defect of octoskin; 73 cannot write;\n"
    "74 a device, standard input or output failed; 77 no permission;\n"
    "78 rig, robot, scenario or mapping file; 130, 143 interrupted by Ctrl-C, SIGTERM: what simulate,\n"
    "replay and experiment had not finished is removed.";

int run(int argc, char** argv) {
    using namespace octoskin;
    CLI::App app{"One map of what a depth camera and the range sensors on a robot arm see."};
    app.set_version_flag("--version", program_version());
    app.require_subcommand(1);
    app.footer(kFooter);
    app::add_simulate_command(app);
    app::add_replay_command(app);
    app::add_evaluate_command(app);
    app::add_experiment_command(app);
    app::add_run_command(app);
    app::add_status_command(app);
    app::add_query_command(app);
    app::add_monitor_command(app);
    app::add_record_command(app);
    app::add_explain_command(app);
    app::add_joints_command(app);
    app::add_cameras_command(app);
    app::add_rig_command(app);
    app::add_mapping_command(app);
    app::add_flash_command(app);
    app::add_black_box_command(app);
    app::add_calibrate_command(app);
    app::add_command_command(app);
    app::add_repair_command(app);
    try {
        app::check_command_name(app, argc, argv);
        app.parse(argc, argv);
        return static_cast<int>(ExitCode::ok);
    } catch (const CLI::RuntimeError& outcome) {  // said already
        return outcome.get_exit_code();
    } catch (const CLI::ParseError& error) {
        std::ostringstream said;
        const int exit_code = app.exit(error, said, std::cerr);
        app::print_text(said.str());
        return exit_code == 0 ? 0 : static_cast<int>(ExitCode::usage);
    } catch (const app::CommandFailure& failure) {
        // First what was printed: it may be what this speaks of. That it could not be is told at the end.
        static_cast<void>(app::flush_standard_output());
        spdlog::error("{}", failure.what());
        return static_cast<int>(failure.code());
    }
}

/// What was done and could not be told is a failure, too.
int checked(int exit_code) {
    const auto failure = octoskin::app::flush_standard_output();
    if (!failure) return exit_code;
    spdlog::error("{}", failure->message);
    return exit_code == 0 ? static_cast<int>(failure->code) : exit_code;
}

}  // namespace

int main(int argc, char** argv) {
    octoskin::app::reserve_standard_descriptors();
    constexpr int kInternal = 70;
    // A reader that goes away (`| head`) must not end the program in the middle of a file.
    std::signal(SIGPIPE, SIG_IGN);
    spdlog::set_default_logger(spdlog::stderr_color_mt("octoskin"));
    spdlog::set_pattern("%H:%M:%S %^%l%$ %v");
    try {
        return checked(run(argc, argv));
    } catch (const std::exception& error) {
        spdlog::critical("a defect of octoskin, please report it: {}", error.what());
        return kInternal;
    }
}
