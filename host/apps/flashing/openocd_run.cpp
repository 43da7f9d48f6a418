#include "host/apps/flashing/openocd_run.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace octoskin::flashing {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kOutputMax = std::size_t{1} << 20U;
constexpr int kFolderInChild = 3;  ///< the number in kOpenocdFolder

/// A child process; the destructor kills it and waits for it.
class Child {
  public:
    Child(pid_t process, int output) : process_(process), output_(output) {}
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;
    ~Child() {
        ::close(output_);
        if (process_ > 0) {
            ::kill(process_, SIGKILL);
            ::waitpid(process_, nullptr, 0);
        }
    }

    /// Reads its output until it closes it. False if that takes longer than `deadline`.
    [[nodiscard]] bool listen(Clock::time_point deadline, std::string& said) const {
        std::array<char, 4096> buffer{};
        while (true) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
            if (left.count() <= 0) return false;
            pollfd waited{.fd = output_, .events = POLLIN, .revents = 0};
            if (::poll(&waited, 1, static_cast<int>(left.count())) <= 0) continue;
            const ssize_t count = ::read(output_, buffer.data(), buffer.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) return true;
            if (said.size() < kOutputMax) said.append(buffer.data(), static_cast<std::size_t>(count));
        }
    }
    [[nodiscard]] int exit_code() {
        int status = 0;
        while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
        process_ = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }

  private:
    pid_t process_;
    int output_;
};

/// Returns the error number, or 0 and the process.
int spawn(const OpenFolder& folder, std::vector<std::string>& arguments, int output, pid_t& process) {
    std::vector<char*> raw;
    raw.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) raw.push_back(argument.data());
    raw.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, "/");
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
    // Last: `output` may have had this number, and is duplicated before.
    posix_spawn_file_actions_adddup2(&actions, folder.descriptor(), kFolderInChild);
    const int error = posix_spawnp(&process, raw[0], &actions, nullptr, raw.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

}  // namespace

OpenocdRun run_openocd(const OpenFolder& folder, std::vector<std::string> arguments,
                       std::chrono::seconds patience) {
    OpenocdRun run;
    const Clock::time_point deadline = Clock::now() + patience;
    arguments.insert(arguments.begin(), "openocd");
    std::array<int, 2> ends{-1, -1};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        run.end = OpenocdRun::End::no_process;
        run.output = std::strerror(errno);
        return run;
    }
    pid_t process = -1;
    const int error = spawn(folder, arguments, ends[1], process);
    ::close(ends[1]);
    Child child(process, ends[0]);
    if (error != 0) {
        run.end = error == ENOENT ? OpenocdRun::End::not_found : OpenocdRun::End::no_process;
        run.output = std::strerror(error);
        return run;
    }
    if (!child.listen(deadline, run.output)) {
        run.end = OpenocdRun::End::timed_out;
        return run;
    }
    run.end = OpenocdRun::End::exited;
    run.exit_code = child.exit_code();
    return run;
}

}  // namespace octoskin::flashing
