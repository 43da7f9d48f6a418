// octoskin run: the daemon beside a robot.
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <cstdlib>
#include <memory>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/log_format.hpp"
#include "host/apps/daemon/daemon.hpp"
#include "host/apps/daemon/log_queue.hpp"
#include "host/apps/daemon/places.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/daemon_signals.hpp"
#include "host/apps/profile/named_mapping.hpp"

namespace octoskin::app {
namespace {

/// With fewer descriptors a save, a recording or the camera could fail later; those that clients hold do not
/// count.
void refuse_few_descriptors() {
    constexpr rlim_t kLeast = 48;
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= kLeast) return;
    throw CommandFailure(
        ExitCode::no_resources,
        {ErrorCode::no_resources, fmt::format("a daemon needs {} descriptors open at once", kLeast),
         fmt::format("a limit of {}", limit.rlim_cur), "raise that limit (ulimit -n)"});
}

Result<std::unique_ptr<Daemon>, AppError> begin(const DaemonRequest& request,
                                                const std::shared_ptr<const LogQueue>& log) {
    const StartGuard guard(log);
    return Daemon::build(request, log);
}

/// Members of the service's group may use its sockets (ControlSocket and JointSocket set their modes) and
/// read its files. With write access to a recording's folder they could create links there while the daemon
/// writes.
void make_files_for_own_user() {
    constexpr mode_t kWrittenByOthers = 0022;
    ::umask(::umask(0) | kWrittenByOthers);
}

void run_daemon(DaemonRequest& request) {
    make_files_for_own_user();
    keep_processor_time_for_the_end();
    refuse_few_descriptors();
    request.can_descriptor = descriptor_of(request.interface);
    const auto log = guard_log();
    std::getenv("JOURNAL_STREAM") != nullptr ? set_journal_format() : set_log_format();
    auto daemon = begin(request, log);
    if (!daemon) throw CommandFailure(daemon.error());
    const ExitCode outcome = (*daemon)->run();
    if (outcome != ExitCode::ok)
        throw CommandFailure(outcome, {ErrorCode::system_error, "ended by a failure: see above"});
}

}  // namespace

void add_run_command(CLI::App& app) {
    auto request = std::make_shared<DaemonRequest>();
    request->control_socket = default_control_socket();
    request->map_folder = default_map_folder();
    CLI::App* command = app.add_subcommand(
        "run", "Run the daemon: a live CAN interface and camera into a map, beside a robot");
    command->add_option("--rig", request->rig, "Rig (YAML)")->required()->check(existing_file());
    add_robot_options(*command, request->robot, "Robot (URDF) in place of the rig's");
    command
        ->add_option("--can", request->interface,
                     "CAN interface, or fd:N, an open socket that carries frames as one")
        ->capture_default_str();
    command->add_flag("--listen-only", request->is_listen_only,
                      "Transmit nothing: another host must send SYNC");
    command
        ->add_option("--configuration", request->configuration,
                     configuration_help("How measurements become voxels"))
        ->capture_default_str();
    auto* const camera =
        command
            ->add_option("--camera", request->cameras,
                         "[NAME=]DEVICE: OpenNI2 device, ros:/TOPIC if a program feeds it, or an .oni file "
                         "to play in a loop, not in step with a bus, of the rig's camera with that name; "
                         "once for each (default: the "
                         "rig's `device`, or the first camera)")
            ->allow_extra_args(false)
            ->type_name("[NAME=]DEVICE");
    command
        ->add_flag_callback(
            "--no-camera", [request] { request->has_camera = false; }, "Do not use the rig's cameras")
        ->excludes(camera);
    command
        ->add_option("--depth-threads", request->depth_threads,
                     "Threads that work on a depth image: the map is the same, and earlier")
        ->check(from_to(1, 16))
        ->capture_default_str();
    command->add_option("--joints", request->joint_socket,
                        "Create this socket and take joint states from it (`octoskin joints`)");
    command
        ->add_option("--maps", request->map_folder, "Folder for the map: fused.ot, fused.bt, fused.snapshot")
        ->capture_default_str();
    command->add_option("--save-every", request->save_period, "Seconds between two saves of the map")
        ->check(from_to(1, 3600))
        ->capture_default_str();
    command->add_option("--socket", request->control_socket, "Control socket, used by `octoskin status`")
        ->capture_default_str();
    command->footer(
        "SIGTERM, SIGINT, SIGQUIT: save the map and end. SIGHUP: read rig, robot and mapping again, all "
        "or\nnone; at most once a second, the last one is obeyed. SIGUSR1 and the like are ignored.\nExit "
        "codes: 0 ended by a signal, the map saved; 64 command line; 65 the saved map is damaged;\n66 no "
        "such file; 69 a socket's folder is missing; 71 too little memory, descriptors or threads\n(ulimit); "
        "73 another daemon has the socket or the maps, or the map cannot be saved; 77 no permission;\n78 "
        "rig, robot or mapping file; 130, 131, 143 SIGINT, SIGQUIT, SIGTERM during a start that hangs.");
    command->callback([request] { run_daemon(*request); });
}

}  // namespace octoskin::app
