// Ctrl-C and SIGTERM in the midst of a command that writes files.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class Interrupted : public ProgramTest {
  protected:
    /// How it ended after it got the signal as soon as `begun` was there; 128 and more: killed by one.
    Said interrupt(const std::string& arguments, const std::string& begun, int signal) const {
        const std::string command = "exec " + typed(arguments) + " > " + path("said") + " 2>&1 < /dev/zero";
        const pid_t process = ::fork();
        if (process == 0) {
            ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            ::_exit(127);
        }
        for (int i = 0; i < 2'000 && !std::filesystem::exists(path(begun)); ++i)
            std::this_thread::sleep_for(10ms);
        EXPECT_TRUE(std::filesystem::exists(path(begun))) << content(path("said"));
        ::kill(process, signal);
        int status = 0;
        ::waitpid(process, &status, 0);
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 1'000 + WTERMSIG(status), content(path("said"))};
    }
};

constexpr const char* kRemoved = "interrupted: unfinished files are removed";

TEST_F(Interrupted, replay_leaves_the_maps_of_the_one_before_and_nothing_else) {
    record_short("rec");
    const std::string replay = "replay " + path("rec") + " --out ";
    const Said first = interrupt(replay + path("new") + " --speed 0.01", "new/.octoskin-part", SIGINT);
    EXPECT_EQ(first.exit_code, 130) << first.output;
    EXPECT_THAT(first.output, HasSubstr(kRemoved));
    EXPECT_FALSE(std::filesystem::exists(path("new")));

    // Whoever closes the terminal.
    const Said hung_up = interrupt(replay + path("new") + " --speed 0.01", "new/.octoskin-part", SIGHUP);
    EXPECT_EQ(hung_up.exit_code, 129) << hung_up.output;
    EXPECT_FALSE(std::filesystem::exists(path("new")));

    ASSERT_EQ(octoskin(replay + path("maps")).exit_code, 0);
    const std::string map = content(path("maps/fused.ot"));
    const Said second = interrupt(replay + path("maps") + " --speed 0.01", "maps/.octoskin-part", SIGTERM);
    EXPECT_EQ(second.exit_code, 143) << second.output;
    EXPECT_FALSE(std::filesystem::exists(path("maps/.octoskin-part")));
    EXPECT_EQ(content(path("maps/fused.ot")), map);
}

TEST_F(Interrupted, simulate_and_experiment_leave_nothing) {
    const Said simulated = interrupt("simulate " + path("rec"), "rec/.octoskin-part/can.log", SIGINT);
    EXPECT_EQ(simulated.exit_code, 130) << simulated.output;
    EXPECT_THAT(simulated.output, HasSubstr(kRemoved));
    EXPECT_FALSE(std::filesystem::exists(path("rec")));

    const Said experiment =
        interrupt("experiment --out " + path("out") + " --rig " + source("tests/data/short/rig.yaml") +
                      " --scenario " + source("tests/data/short/scenario.yaml"),
                  "out/recording/.octoskin-part/can.log", SIGTERM);
    EXPECT_EQ(experiment.exit_code, 143) << experiment.output;
    EXPECT_THAT(experiment.output, HasSubstr(kRemoved));
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(Interrupted, is_in_the_help_where_exit_codes_are) {
    EXPECT_THAT(octoskin("--help").output, HasSubstr("130, 131, 143 interrupted"));
}

}  // namespace
}  // namespace octoskin
