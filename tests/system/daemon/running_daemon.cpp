#include "tests/system/daemon/running_daemon.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "host/apps/daemon/daemon_client.hpp"

namespace octoskin::test {

using namespace std::chrono_literals;

RunningDaemon::RunningDaemon(const testing_support::ScratchFolder& folder, int descriptor,
                             const std::vector<std::string>& more_arguments, const std::filesystem::path& rig)
    : folder_(folder) {
    constexpr int kItsDescriptor = 3;
    std::vector<std::string> arguments{OCTOSKIN_PROGRAM, "run",  "--rig",  rig.string(),
                                       "--can",          "fd:3", "--maps", maps().string()};
    if (std::ranges::find(more_arguments, "--socket") == more_arguments.end())
        arguments.insert(arguments.end(), {"--socket", (folder_ / "control").string()});
    arguments.insert(arguments.end(), more_arguments.begin(), more_arguments.end());
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const std::string log_file = (folder_ / "log").string();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, descriptor, kItsDescriptor);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log_file.c_str(), O_WRONLY | O_CREAT | O_APPEND,
                                     0600);
    EXPECT_EQ(posix_spawn(&process_, OCTOSKIN_PROGRAM, &actions, nullptr, pointers.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    ::close(descriptor);
}

RunningDaemon::~RunningDaemon() {
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
}

void RunningDaemon::signal(int number) const {
    ASSERT_GT(process_, 0);
    ::kill(process_, number);
}

std::optional<int> RunningDaemon::wait(std::chrono::milliseconds patience) {
    const auto end = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < end) {
        int status = 0;
        if (::waitpid(process_, &status, WNOHANG) == process_) {
            process_ = -1;
            return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
        }
        std::this_thread::sleep_for(5ms);
    }
    return std::nullopt;
}

nlohmann::json RunningDaemon::status() const {
    const auto answer = ask_daemon(folder_ / "control", "status");
    return answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
}

std::optional<std::chrono::milliseconds> RunningDaemon::wait_until(
    const std::function<bool(const nlohmann::json&)>& holds, std::chrono::milliseconds patience) const {
    const auto begin = std::chrono::steady_clock::now();
    while (true) {  // until the patience is over
        const nlohmann::json now = status();
        const auto took =
            std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - begin);
        if (now.is_object() && holds(now)) return took;
        if (took > patience) return std::nullopt;
        std::this_thread::sleep_for(20ms);
    }
}

std::string RunningDaemon::log() const {
    return testing_support::ScratchFolder::read(folder_ / "log");
}

}  // namespace octoskin::test
