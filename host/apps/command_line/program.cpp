#include "host/apps/command_line/program.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/apps/command_line/error_json.hpp"
#include "host/apps/command_line/log_format.hpp"
#include "host/apps/command_line/standard_output.hpp"
#include "host/apps/recording/shortage.hpp"
#include "host/apps/version/version.hpp"

namespace {

bool has_json_errors = false;

/// Prints the error of the command that it ends, and returns the exit code.
int report(const octoskin::AppError& error) {
    const int exit_code = static_cast<int>(error.exit);
    if (has_json_errors) {
        using Json = nlohmann::ordered_json;
        const Json json{{"exit", exit_code}, {"error", octoskin::to_json(error.error)}};
        const std::string line = json.dump(-1, ' ', false, Json::error_handler_t::replace);
        fmt::print(stderr, "{}\n", octoskin::printable_json(line));
    } else {
        spdlog::error("{}", error.message());
    }
    return exit_code;
}

/// The error in the command line. CLI11 gives only a sentence, of which option and value are taken if they
/// are in it: "--seed: expected a whole number, found 'x'".
octoskin::Error usage_error(const CLI::ParseError& parsed) {
    constexpr std::string_view kAfterOption = ": ";
    constexpr std::string_view kFound = ", found ";
    octoskin::Error error{.code = octoskin::ErrorCode::bad_argument,
                          .what = parsed.what(),
                          .remedy = "run with --help for more information"};
    const std::size_t option_end = error.what.find(kAfterOption);
    if (error.what.starts_with("--") && option_end != std::string::npos) {
        error.key = error.what.substr(0, option_end);
        error.what.erase(0, option_end + kAfterOption.size());
    }
    if (const std::size_t found = error.what.rfind(kFound); found != std::string::npos) {
        error.value = error.what.substr(found + kFound.size());
        error.what.resize(found);
    }
    return error;
}

/// The error in the command line as one printable line (it may contain file names), then CLI11's hint.
std::string harmless_message(const CLI::App* app, const CLI::Error& error) {
    const std::string what = error.what();
    const std::string whole = CLI::FailureMessage::simple(app, error);
    return octoskin::printable(what) + (whole.starts_with(what) ? whole.substr(what.size()) : "\n");
}

/// A misspelt option is the cause of what else is wrong: its value is taken for an argument, or the option
/// that was meant is missing.
void parse(CLI::App& app, const std::string& program, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success&) {  // --help, --version
        throw;
    } catch (const CLI::RuntimeError&) {  // reported already
        throw;
    } catch (const CLI::ParseError&) {
        octoskin::app::check_option_names(app, program);
        throw;
    } catch (const octoskin::app::CommandFailure&) {
        octoskin::app::check_option_names(app, program);
        throw;
    }
}

int run(const octoskin::app::Program& program, int argc, char** argv) {
    using namespace octoskin;
    CLI::App app{program.description, program.name};  // not the path by which it was started
    app.set_version_flag("--version", program_version(program.name));
    app.add_flag(std::string(app::kJsonErrors), has_json_errors,
                 "Before the command: print an error as one line of JSON on standard error")
        ->disable_flag_override();
    app.require_subcommand(1);
    app.failure_message(harmless_message);
    app.footer(program.footer);
    program.add_commands(app);
    try {
        app::check_json_errors(argc, argv);
        app::check_command_name(app, program.others, argc, argv);
        parse(app, program.name, argc, argv);
        return static_cast<int>(ExitCode::ok);
    } catch (const CLI::RuntimeError& outcome) {  // reported already
        return outcome.get_exit_code();
    } catch (const CLI::ParseError& error) {
        if (has_json_errors && error.get_exit_code() != 0)
            return report({ExitCode::usage, usage_error(error)});
        std::ostringstream said;
        const int exit_code = app.exit(error, said, std::cerr);
        app::print_text(said.str());
        return exit_code == 0 ? 0 : static_cast<int>(ExitCode::usage);
    } catch (const app::CommandFailure& failure) {
        // First the output that was printed: the message may refer to it. A failed write is reported at the
        // end.
        static_cast<void>(app::flush_standard_output());
        return report(failure.error());
    }
}

/// If the output cannot be written, the command fails, even if its work succeeded or its exit code is a
/// result (1, 2).
int checked(int exit_code) {
    const auto failure = octoskin::app::flush_standard_output();
    if (!failure) return exit_code;
    const int failed = report(*failure);
    const bool is_done = exit_code <= static_cast<int>(octoskin::ExitCode::uncertain);
    return is_done ? failed : exit_code;
}

/// With lower limits a command would fail halfway: a stack overflow cannot be caught, and without descriptors
/// a file looks unreadable. Returns the error, or nothing if the limits suffice.
std::optional<octoskin::Error> too_little() {
    using octoskin::Error;
    using octoskin::ErrorCode;
    constexpr rlim_t kStackLeast = rlim_t{1} << 20U;
    constexpr rlim_t kDescriptorsLeast = 16;
    rlimit limit{};
    if (::getrlimit(RLIMIT_STACK, &limit) == 0 && limit.rlim_cur < kStackLeast)
        return Error{ErrorCode::no_resources,
                     fmt::format("this process needs {} KiB of stack", kStackLeast >> 10U),
                     fmt::format("a limit of {} KiB", limit.rlim_cur >> 10U), "raise that limit (ulimit -s)"};
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < kDescriptorsLeast)
        return Error{ErrorCode::no_resources,
                     fmt::format("this process needs {} descriptors open at once", kDescriptorsLeast),
                     fmt::format("a limit of {}", limit.rlim_cur), "raise that limit (ulimit -n)"};
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
        if (shortage) return report(*shortage);
        const octoskin::Error defect{octoskin::ErrorCode::self_check,
                                     std::string("a defect of octoskin, please report it: ") + thrown.what()};
        if (has_json_errors) return report({static_cast<octoskin::ExitCode>(kInternal), defect});
        spdlog::critical("{}", defect.message());
        return kInternal;
    } catch (...) {
        constexpr std::string_view kWords = "octoskin: out of memory (see ulimit -v)\n";
        constexpr std::string_view kJson =
            "{\"exit\":71,\"error\":{\"code\":\"no_resources\",\"message\":\"out of memory\"}}\n";
        const std::string_view text = has_json_errors ? kJson : kWords;
        (void)!::write(STDERR_FILENO, text.data(), text.size());
        return static_cast<int>(octoskin::ExitCode::no_resources);
    }
}

}  // namespace

namespace octoskin::app {

int run_program(const Program& program, int argc, char** argv) noexcept {
    reserve_standard_descriptors();
    has_json_errors = wants_json_errors(argc, argv);
    // A closed reader (`| head`) or a file size limit (ulimit -f) must not end the process in the middle of a
    // file. With these signals ignored, both become write errors, which are reported.
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
    try {
        spdlog::set_default_logger(spdlog::stderr_color_mt(program.name));
        set_log_format();
        if (const auto shortage = too_little()) return report({ExitCode::no_resources, *shortage});
        if (!has_proc())
            return report({ExitCode::unavailable,
                           {.code = ErrorCode::unsupported,
                            .what = "is not mounted, and octoskin opens files through it",
                            .remedy = "mount it",
                            .file = "/proc"}});
        return checked(run(program, argc, argv));
    } catch (const std::exception& error) {
        return tell(error);
    }
}

}  // namespace octoskin::app
