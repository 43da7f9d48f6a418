#include "host/apps/octoskin/bridge_program.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/command_failure.hpp"
#include "host/io/openni2/helper_process.hpp"

namespace octoskin::app {
namespace {

constexpr const char* kProgram = "octoskin-bridge";

std::filesystem::path find_bridge() {
    const auto program = openni2::find_helper(kProgram);
    if (program) return *program;
    throw CommandFailure(
        ExitCode::unavailable,
        {.code = ErrorCode::no_program,
         .what = std::string(kProgram) + " is not installed",
         .remedy = "install the package octoskin-bridge (in a build: its target of this name)"});
}

/// The arguments as exec takes them; `words` must outlive them.
std::vector<char*> pointers_to(std::vector<std::string>& words) {
    words.insert(words.begin(), kProgram);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    return pointers;
}

[[noreturn]] void not_started(const std::filesystem::path& program, int error) {
    throw CommandFailure(ExitCode::unavailable,
                         {.code = ErrorCode::no_program, .what = std::strerror(error), .file = program});
}

constexpr int kNotStarted = 127;  // the convention of shells

/// Between fork and exec: calls that are safe there only. The child ends with this process, whose temporary
/// files it would go on to write.
[[noreturn]] void run_as_child(const std::filesystem::path& program, const std::vector<char*>& arguments,
                               pid_t parent) {
    sigset_t none;
    sigemptyset(&none);  // the parent may wait for its signals in a thread
    (void)::pthread_sigmask(SIG_SETMASK, &none, nullptr);
    (void)::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() == parent) ::execv(program.c_str(), arguments.data());
    ::_exit(kNotStarted);
}

}  // namespace

void check_bridge() {
    (void)find_bridge();
}

std::vector<std::string> with_form_of_errors(const CLI::App& command, std::vector<std::string> words) {
    const std::string option(kJsonErrors);
    if (command.get_parent()->get_option(option)->count() > 0) words.insert(words.begin(), option);
    return words;
}

void become_bridge(std::vector<std::string> words) {
    const std::filesystem::path program = find_bridge();
    ::execv(program.c_str(), pointers_to(words).data());
    not_started(program, errno);
}

int run_bridge(std::vector<std::string> words) {
    constexpr int kSignalled = 128;  // the convention of shells
    const std::filesystem::path program = find_bridge();
    const std::vector<char*> arguments = pointers_to(words);
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child < 0) not_started(program, errno);
    if (child == 0) run_as_child(program, arguments, parent);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0)
        if (errno != EINTR) not_started(program, errno);
    if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted) not_started(program, ENOEXEC);
    return WIFEXITED(status) ? WEXITSTATUS(status) : kSignalled + WTERMSIG(status);
}

}  // namespace octoskin::app
