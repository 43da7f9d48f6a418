// octoskin view
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <memory>
#include <utility>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/log_format.hpp"
#include "host/apps/daemon/log_limit.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/playback/playback_options.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"
#include "host/bridge/view/live_view.hpp"
#include "host/bridge/view/page_files.hpp"
#include "host/bridge/view/recorded_view.hpp"

namespace octoskin::bridge {
namespace {

using app::CommandFailure;

CLI::Validator origin() {
    return {[](const std::string& text) -> std::string {
                return view::is_origin(text) ? ""
                                             : "expected an origin as https://app.foxglove.dev, without a "
                                               "path, found '" +
                                                   text + "'";
            },
            "ORIGIN"};
}

/// A foreign page or a client that tries again and again writes lines at a bounded rate.
void begin_log() {
    auto sinks = spdlog::default_logger()->sinks();
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("octoskin", std::make_shared<LogLimit>(std::move(sinks))));
    std::getenv("JOURNAL_STREAM") != nullptr ? app::set_journal_format() : app::set_log_format();
}

void check_host(const std::string& host) {
    if (host != "0.0.0.0" && host != "::" && host != "[::]") return;
    throw CommandFailure(
        ExitCode::usage,
        {.code = ErrorCode::bad_argument,
         .what = "--host must be the address or name by which a browser reaches this machine",
         .value = "'" + host + "'",
         .remedy = "give that one address, as 192.168.1.20"});
}

bool is_loopback(const std::string& host) {
    return host == "localhost" || host.starts_with("127.") || host == "::1" || host == "[::1]";
}

struct ViewOptions {
    std::filesystem::path control = default_control_socket();
    app::PlaybackOptions playback;  ///< of a recording; without one: live
    view::WebOptions web;
};

template <class View>
void serve(Result<std::unique_ptr<View>, AppError> view, bool has_page) {
    if (!view) throw CommandFailure(view.error());
    spdlog::info("the view is at {}{}", (*view)->url(),
                 has_page ? "" : " (without its page: " + view::page_folder().string() + " has none)");
    (*view)->run();
}

void run_view(ViewOptions& options) {
    begin_log();
    check_host(options.web.host);
    options.web.files = view::read_page(view::page_folder());
    options.web.file_missing =
        "The page is not built, because the build found no node: only programs like Foxglove can connect.";
    const bool has_page = !options.web.files.empty();
    if (!is_loopback(options.web.host))
        spdlog::warn(
            "every program and every person that reaches {} sees what the robot sees: there is no "
            "password and no encryption",
            options.web.host);
    const bool is_live = options.playback.recording.empty();
    const bool has_rig = !options.playback.rig.empty() || !options.playback.robot.urdf.empty();
    if (is_live && has_rig)
        throw CommandFailure(ExitCode::usage,
                             {.code = ErrorCode::conflict,
                              .what = "--rig and --robot are of a recording: a daemon has its own",
                              .remedy = "give a recording, too, or leave them out"});
    MeshSearch meshes = mesh_search(options.playback.robot.packages);
    if (is_live)
        serve(view::LiveView::open(options.control, options.web, std::move(meshes)), has_page);
    else
        serve(
            view::RecordedView::open(app::playback_request(options.playback), options.web, std::move(meshes)),
            has_page);
}

}  // namespace

void add_view_command(CLI::App& app) {
    auto options = std::make_shared<ViewOptions>();
    view::WebOptions& web = options->web;
    CLI::App* command = app.add_subcommand(
        "view",
        "Show the map live, or a recording: a page for a browser, and a server for Foxglove and Lichtblick");
    command
        ->add_option("recording", options->playback.recording,
                     "Directory of a recording to play instead of showing a daemon's map")
        ->check(app::existing_path());
    command->add_option("--socket", options->control, "Control socket of the daemon")->capture_default_str();
    command
        ->add_option("--host", web.host,
                     "Address or name of this machine to listen at, by which a browser reaches it")
        ->capture_default_str();
    command->add_option("--port", web.port, "Port; 0: any that is free")->capture_default_str();
    command
        ->add_option("--allow-origin", web.origins,
                     "A further origin whose pages may connect, as https://app.foxglove.dev; repeatable")
        ->check(origin())
        ->expected(1)
        ->take_all();
    app::add_recording_options(*command, options->playback);
    command->callback([options] { run_view(*options); });
}

}  // namespace octoskin::bridge
