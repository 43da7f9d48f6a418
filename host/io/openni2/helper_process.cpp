#include "host/io/openni2/helper_process.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <thread>
#include <utility>

namespace octoskin::openni2 {
namespace {

/// Room for a frame of 512 x 424, where Linux gives half.
constexpr int kSendBuffer = 1 << 20;

}  // namespace

Result<HelperProcess, std::string> HelperProcess::start(const std::filesystem::path& program,
                                                        const std::string& argument, HelperPipe pipe) {
    std::array<int, 2> ends{-1, -1};
    // Sockets rather than a pipe: a write to a helper that is stuck must not block, and one to a helper that
    // is gone must not raise SIGPIPE.
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
        return unexpected(std::string("no socket: ") + std::strerror(errno));
    const auto [ours, theirs] = ends;
    for (const int end : ends) ::setsockopt(end, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof(kSendBuffer));
    const bool is_input = pipe == HelperPipe::its_input;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, theirs, is_input ? STDIN_FILENO : STDOUT_FILENO);
    std::string name = program.string();
    std::string value = argument;
    std::array<char*, 3> arguments{name.data(), value.data(), nullptr};
    pid_t process = -1;
    const int failed = posix_spawn(&process, name.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(theirs);
    if (failed != 0) {
        ::close(ours);
        return unexpected("cannot start " + name + ": " + std::strerror(failed));
    }
    return HelperProcess(process, ours);
}

HelperProcess::HelperProcess(HelperProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)), descriptor_(std::exchange(other.descriptor_, -1)) {}

HelperProcess& HelperProcess::operator=(HelperProcess&& other) noexcept {
    if (this != &other) {
        end();
        process_ = std::exchange(other.process_, -1);
        descriptor_ = std::exchange(other.descriptor_, -1);
    }
    return *this;
}

HelperProcess::~HelperProcess() {
    end();
}

void HelperProcess::close_pipe() {
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

void HelperProcess::end() {
    close_pipe();
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(std::exchange(process_, -1), nullptr, 0);
}

std::optional<std::string> HelperProcess::wait(std::chrono::milliseconds patience) {
    constexpr std::chrono::milliseconds kStep{5};
    for (std::chrono::milliseconds waited{0};; waited += kStep) {
        int status = 0;
        const pid_t ended = ::waitpid(process_, &status, WNOHANG);
        if (ended == process_) {
            process_ = -1;
            if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
            if (WEXITSTATUS(status) != 0) return "exit code " + std::to_string(WEXITSTATUS(status));
            return std::nullopt;
        }
        if (ended < 0) return std::string("no such process");
        if (waited >= patience) {
            end();
            return std::string("did not end in time");
        }
        std::this_thread::sleep_for(kStep);
    }
}

std::optional<std::filesystem::path> find_helper(const std::string& name) {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
    for (const auto& directory :
         {self, self.parent_path() / "libexec" / "octoskin", std::filesystem::path(OCTOSKIN_HELPER_DIR)}) {
        if (std::filesystem::exists(directory / name, error)) return directory / name;
    }
    return std::nullopt;
}

}  // namespace octoskin::openni2
