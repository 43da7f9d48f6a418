#include "host/apps/command_line/program.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <iostream>
#include <optional>
#include <sstream>
#include <string_view>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/log_format.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/recording/shortage.hpp"
#include "host/apps/version/version.hpp"

namespace {

/// What is wrong with the command line, in which files of others may be named, on one line; then CLI11's own.
std::string harmless_message(const CLI::App* app, const CLI::Error& error) {
    const std::string what = error.what();
    const std::string whole = CLI::FailureMessage::simple(app, error);
    return octoskin::printable(what) + (whole.starts_with(what) ? whole.substr(what.size()) : "\n");
}

int run(const octoskin::app::Program& program, int argc, char** argv) {
    using namespace octoskin;
    CLI::App app{program.description};
    app.set_version_flag("--version", program_version(program.name));
    app.require_subcommand(1);
    app.failure_message(harmless_message);
    app.footer(program.footer);
    program.add_commands(app);
    try {
        app::check_command_name(app, program.others, argc, argv);
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
        // First what was printed: the message may be about it. A failure to print is reported at the end.
        static_cast<void>(app::flush_standard_output());
        spdlog::error("{}", failure.what());
        return static_cast<int>(failure.code());
    }
}

/// Work that was done and whose output could not be written is a failure, too; so is an answer (1, 2).
int checked(int exit_code) {
    const auto failure = octoskin::app::flush_standard_output();
    if (!failure) return exit_code;
    spdlog::error("{}", failure->message);
    const bool is_done = exit_code <= static_cast<int>(octoskin::ExitCode::uncertain);
    return is_done ? static_cast<int>(failure->code) : exit_code;
}

/// With less a command fails somewhere in its midst: of the stack with a fault that nothing can catch, of
/// descriptors with a file that it calls unreadable. Empty: there is enough to begin with.
std::optional<std::string> too_little() {
    constexpr rlim_t kStackLeast = rlim_t{1} << 20U;
    constexpr rlim_t kDescriptorsLeast = 16;
    rlimit limit{};
    if (::getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur < kStackLeast)
        return fmt::format(
            "this process may have {} KiB of stack, and needs {}: raise that limit (ulimit -s)",
            limit.rlim_cur >> 10U, kStackLeast >> 10U);
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < kDescriptorsLeast)
        return fmt::format(
            "this process may have {} descriptors open at once, and needs {}: raise that limit (ulimit -n)",
            limit.rlim_cur, kDescriptorsLeast);
    return std::nullopt;
}

/// Files are opened by their descriptors' names there, so that no link is followed in between; and the
/// helpers are found by it. Without it each file would be "no such file".
bool has_proc() {
    return ::access("/proc/self/fd", R_OK | X_OK) == 0 && ::access("/proc/self/exe", F_OK) == 0;
}

/// What was thrown, and the exit code for it. There may be no memory to say it in.
int tell(const std::exception& thrown) noexcept {
    constexpr int kInternal = 70;
    try {
        const auto shortage = octoskin::shortage_in(thrown);
        if (shortage) {
            spdlog::error("{}", shortage->message);
            return static_cast<int>(shortage->code);
        }
        spdlog::critical("a defect of octoskin, please report it: {}", thrown.what());
        return kInternal;
    } catch (...) {
        constexpr std::string_view kWords = "octoskin: no memory (ulimit -v)\n";
        (void)!::write(STDERR_FILENO, kWords.data(), kWords.size());
        return static_cast<int>(octoskin::ExitCode::no_resources);
    }
}

}  // namespace

namespace octoskin::app {

int run_program(const Program& program, int argc, char** argv) noexcept {
    reserve_standard_descriptors();
    // A reader that goes away (`| head`) must not end the program in the middle of a file, nor must the limit
    // of a file's size (ulimit -f): both are errors of the write, which are reported.
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
    try {
        spdlog::set_default_logger(spdlog::stderr_color_mt(program.name));
        set_log_format();
        if (const auto shortage = too_little()) {
            spdlog::error("{}", *shortage);
            return static_cast<int>(ExitCode::no_resources);
        }
        if (!has_proc()) {
            spdlog::error("there is no /proc here, through which octoskin opens files: mount it");
            return static_cast<int>(ExitCode::unavailable);
        }
        return checked(run(program, argc, argv));
    } catch (const std::exception& error) {
        return tell(error);
    }
}

}  // namespace octoskin::app
