// octoskin-node: a sensor node on a Linux board.
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <string>
#include <variant>

#include "firmware/app/linux_node/arguments.hpp"
#include "firmware/app/linux_node/board.hpp"
#include "firmware/app/linux_node/configuration.hpp"
#include "firmware/app/linux_node/journal.hpp"
#include "firmware/port/linux/service_manager.hpp"
#include "firmware/port/linux/unique_id.hpp"

namespace octoskin::linux_node {
namespace {

using linux_port::ExitCode;
using linux_port::refuse;
using linux_port::StartFailure;

/// A descriptor that is readable once a signal asks this process to end. Call before any thread starts:
/// threads inherit the blocked signals.
int take_signals() {
    sigset_t signals{};
    ::sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGQUIT}) ::sigaddset(&signals, signal);
    // The descriptor first: if it cannot be made, the signals must not stay blocked.
    const int descriptor = ::signalfd(-1, &signals, SFD_CLOEXEC);
    if (descriptor >= 0) ::sigprocmask(SIG_BLOCK, &signals, nullptr);
    return descriptor;
}

Result<node::Identity, StartFailure> identity_of(const Arguments& arguments) {
    const auto uid = arguments.uid ? arguments.uid : linux_port::unique_id(arguments.i2c);
    if (!uid)
        return refuse(ExitCode::unavailable,
                      "/etc/machine-id: no machine id (`systemd-machine-id-setup` makes one); or give --uid");
    return node::Identity{.uid = *uid, .build_id = OCTOSKIN_BUILD_ID, .board_type = kBoardType};
}

/// A thread blocked in the kernel cannot be ended. Ends the process with the thread still in the kernel.
[[noreturn]] void leave_behind(const Board::Left& left, ExitCode code) {
    for (const std::string& bus : left.stuck)
        say(bus + ": a transfer does not return from the kernel; ending without it");
    std::exit(static_cast<int>(code));  // writes the queued lines, but does not destroy the board
}

void say_stopped(const Board::Left& left) {
    if (left.xshut_refused == 0) return say("stopped: all sensors are in reset");
    say("stopped: the kernel refused to set " + std::to_string(left.xshut_refused) +
        " XSHUT lines low; their sensors may still range");
}

/// Runs one node after the other: a reset ordered by the host ends one and starts the next, as on a
/// microcontroller.
Result<Done, StartFailure> run(const Arguments& arguments) {
    const auto config = load_configuration(arguments);
    if (!config) return unexpected(config.error());
    auto identity = identity_of(arguments);
    if (!identity) return unexpected(identity.error());
    const int stop = take_signals();
    if (stop < 0)
        return refuse(ExitCode::unavailable,
                      std::string("cannot take signals: ") + std::strerror(errno) + " (`ulimit -n`)");
    node::KeptMemory kept{};
    Journal journal;
    auto manager = linux_port::ServiceManager::from_environment();
    while (true) {
        auto board = Board::open(arguments, *config, *identity, kept);
        if (!board) return unexpected(board.error());
        journal.started(*config, arguments.can, OCTOSKIN_BUILD_ID);
        const Board::Ending ending = (*board)->run(stop, journal, manager);
        const Board::Left left = (*board)->end();
        if (ending == Board::Ending::stopped) {
            manager.stopping();
            say_stopped(left);
            if (!left.stuck.empty()) leave_behind(left, ExitCode::ok);
            return Done{};
        }
        say("reset, ordered by the host");
        // The service manager restarts the program.
        if (!left.stuck.empty()) leave_behind(left, ExitCode::unavailable);
        identity->reset_cause = wire::ResetCause::software;
    }
}

}  // namespace
}  // namespace octoskin::linux_node

int main(int argc, char** argv) {
    using namespace octoskin::linux_node;
    try {
        const auto arguments = parse_arguments(argc, argv, OCTOSKIN_BUILD_ID);
        if (const auto* code = std::get_if<ExitCode>(&arguments)) return static_cast<int>(*code);
        const auto done = run(std::get<Arguments>(arguments));
        if (done) return static_cast<int>(ExitCode::ok);
        say(done.error().what);
        return static_cast<int>(done.error().code);
    } catch (const std::exception& error) {
        say(std::string("a defect of octoskin-node, please report it: ") + error.what());
        return static_cast<int>(ExitCode::defect);
    }
}
