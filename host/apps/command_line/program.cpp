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

/// The error in the command line as one printable line (it may contain file names), then CLI11's hint.
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
    } catch (const CLI::RuntimeError& outcome) {  // reported already
        return outcome.get_exit_code();
    } catch (const CLI::ParseError& error) {
        std::ostringstream said;
        const int exit_code = app.exit(error, said, std::cerr);
        app::print_text(said.str());
        return exit_code == 0 ? 0 : static_cast<int>(ExitCode::usage);
    } catch (const app::CommandFailure& failure) {
        // First the output that was printed: the message may refer to it. A failed write is reported at the
        // end.
        static_cast<void>(app::flush_standard_output());
        spdlog::error("{}", failure.what());
        return static_cast<int>(failure.code());
    }
}

/// If the output cannot be written, the command fails, even if its work succeeded or its exit code is a
/// result (1, 2).
int checked(int exit_code) {
    const auto failure = octoskin::app::flush_standard_output();
    if (!failure) return exit_code;
    spdlog::error("{}", failure->message);
    const bool is_done = exit_code <= static_cast<int>(octoskin::ExitCode::uncertain);
    return is_done ? static_cast<int>(failure->code) : exit_code;
}

/// With lower limits a command would fail halfway: a stack overflow cannot be caught, and without descriptors
/// a file looks unreadable. Returns the message, or nothing if the limits suffice.
std::optional<std::string> too_little() {
    constexpr rlim_t kStackLeast = rlim_t{1} << 20U;
    constexpr rlim_t kDescriptorsLeast = 16;
    rlimit limit{};
    if (::getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur < kStackLeast)
        return fmt::format("this process may have {} KiB of stack and needs {}: raise that limit (ulimit -s)",
                           limit.rlim_cur >> 10U, kStackLeast >> 10U);
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < kDescriptorsLeast)
        return fmt::format(
            "this process may have {} descriptors open at once and needs {}: raise that limit (ulimit -n)",
            limit.rlim_cur, kDescriptorsLeast);
    return std::nullopt;
}

/// /proc serves two purposes: files are reopened by their descriptors, so that no link is followed in
/// between, and the helper programs are found through it. Without /proc every file would be reported as "no
/// such file".
bool has_proc() {
    return ::access("/proc/self/fd", R_OK | X_OK) == 0 && ::access("/proc/self/exe", F_OK) == 0;
}

/// Prints the message of an exception and returns its exit code. Must work without free memory.
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
        constexpr std::string_view kWords = "octoskin: out of memory (see ulimit -v)\n";
        (void)!::write(STDERR_FILENO, kWords.data(), kWords.size());
        return static_cast<int>(octoskin::ExitCode::no_resources);
    }
}

}  // namespace

namespace octoskin::app {

int run_program(const Program& program, int argc, char** argv) noexcept {
    reserve_standard_descriptors();
    // A closed reader (`| head`) or a file size limit (ulimit -f) must not end the process in the middle of a
    // file. With these signals ignored, both become write errors, which are reported.
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
    try {
        spdlog::set_default_logger(spdlog::stderr_color_mt(program.name));
        set_log_format();
        if (const auto shortage = too_little()) {
            spdlog::error("{}", *shortage);
            return static_cast<int>(ExitCode::no_resources);
        }
        if (!has_proc()) {
            spdlog::error("/proc is not mounted, and octoskin opens files through it: mount it");
            return static_cast<int>(ExitCode::unavailable);
        }
        return checked(run(program, argc, argv));
    } catch (const std::exception& error) {
        return tell(error);
    }
}

}  // namespace octoskin::app
