// `octoskin joints` in front of a daemon that comes and goes.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/socketcan/can_socket.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;

/// The daemon's end.
class Taker {
  public:
    explicit Taker(const std::filesystem::path& file)
        : file_(file), descriptor_(bind_unix_socket(file, SOCK_DGRAM)->descriptor) {}
    ~Taker() {
        ::close(descriptor_);
        ::unlink(file_.c_str());
    }
    Taker(const Taker&) = delete;
    Taker& operator=(const Taker&) = delete;
    [[nodiscard]] bool gets_a_line(std::chrono::milliseconds patience) const {
        pollfd readable{descriptor_, POLLIN, 0};
        std::array<char, 64> text{};
        return ::poll(&readable, 1, static_cast<int>(patience.count())) > 0 &&
               ::recv(descriptor_, text.data(), text.size(), 0) == 5;
    }

  private:
    std::filesystem::path file_;
    int descriptor_;
};

TEST(JointsCommand, waits_for_the_daemon_and_takes_it_back) {
    const testing_support::ScratchFolder folder;
    const auto file = folder / "joints";
    const std::string command = "(for i in $(seq 200); do echo 1 2 3; sleep 0.02; done) | " OCTOSKIN_PROGRAM
                                " joints --socket " +
                                file.string() + " 2> " + (folder / "log").string();
    int outcome = -1;
    std::thread forwarder([&] { outcome = std::system(command.c_str()); });
    std::this_thread::sleep_for(300ms);
    {
        const Taker first(file);
        EXPECT_TRUE(first.gets_a_line(1s));
    }
    std::this_thread::sleep_for(300ms);
    const Taker second(file);
    EXPECT_TRUE(second.gets_a_line(1s));
    forwarder.join();
    EXPECT_EQ(WEXITSTATUS(outcome), 0);
    const std::string log = testing_support::ScratchFolder::read(folder / "log");
    EXPECT_NE(log.find("waiting for it"), std::string::npos) << log;
    EXPECT_NE(log.find("are sent again"), std::string::npos) << log;
}

// The kernel keeps ten of them.
TEST(JointsCommand, loses_nothing_of_a_burst_while_the_daemon_is_slow) {
    constexpr int kLines = 60;
    const testing_support::ScratchFolder folder;
    const Taker taker(folder / "joints");
    const std::string command = "yes 1 2 3 | head -n " + std::to_string(kLines) +
                                " | " OCTOSKIN_PROGRAM " joints --socket " + (folder / "joints").string() +
                                " 2> " + (folder / "log").string();
    int outcome = -1;
    std::thread forwarder([&] { outcome = std::system(command.c_str()); });
    int taken = 0;
    for (; taken < kLines && taker.gets_a_line(2s); ++taken) std::this_thread::sleep_for(5ms);
    forwarder.join();
    EXPECT_EQ(WEXITSTATUS(outcome), 0);
    EXPECT_EQ(taken, kLines) << testing_support::ScratchFolder::read(folder / "log");
}

TEST(JointsCommand, holds_nobody_up_for_a_daemon_that_is_stuck) {
    const testing_support::ScratchFolder folder;
    const Taker stuck(folder / "joints");
    const std::string command = "yes 1 2 3 | head -n 300 | " OCTOSKIN_PROGRAM " joints --socket " +
                                (folder / "joints").string() + " 2> " + (folder / "log").string();
    const auto begun = std::chrono::steady_clock::now();
    (void)std::system(command.c_str());
    EXPECT_LT(std::chrono::steady_clock::now() - begun, 5s) << "300 lines of 100 ms would be 30 s";
    const std::string log = testing_support::ScratchFolder::read(folder / "log");
    EXPECT_NE(log.find("accepts no samples"), std::string::npos) << log;
}

TEST(JointsCommand, says_at_the_end_that_nobody_was_there) {
    const testing_support::ScratchFolder folder;
    const std::string command =
        "echo 1 2 3 | " OCTOSKIN_PROGRAM " joints --socket " + (folder / "nobody").string() + " 2> /dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 69);
}

TEST(JointsCommand, tells_each_reason_why_lines_are_refused) {
    const testing_support::ScratchFolder folder;
    const std::string command = "printf '1 2\\n3 4\\nx y z\\n' | " OCTOSKIN_PROGRAM
                                " joints --rig " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml --socket " +
                                (folder / "nobody").string() + " 2> " + (folder / "log").string();
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 69);
    const std::string log = testing_support::ScratchFolder::read(folder / "log");
    EXPECT_NE(log.find("warning line not sent, wrong_count: 2 numbers, the rig has 7 joints, found '1 2'"),
              std::string::npos)
        << log;
    EXPECT_EQ(log.find("'3 4'"), std::string::npos) << "once for each reason:\n" << log;
    EXPECT_NE(log.find("warning line not sent, not_a_number"), std::string::npos) << log;
    EXPECT_NE(log.find("0 lines sent, 0 lost, 3 refused"), std::string::npos) << log;
}

/// As whoever starts and ends it by hand does: what became of the lines is told as at the end of the input.
TEST(JointsCommand, tells_what_became_of_the_lines_when_a_signal_ends_it) {
    for (const std::string signal : {"INT", "TERM"}) {
        const testing_support::ScratchFolder folder;
        const Taker taker(folder / "joints");
        // A shell in the background lets its commands ignore SIGINT.
        const auto script = folder.write(
            "script", "cd " + folder.path().string() +
                          "; mkfifo input; exec 3<>input; printf '0 0 0 -1 0 1 0\\n1 2 3\\n1 2' >&3\n"
                          "python3 -c 'import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); "
                          "os.execv(sys.argv[1], sys.argv[1:])' " OCTOSKIN_PROGRAM
                          " joints --rig " OCTOSKIN_SOURCE_DIR
                          "/hw/rigs/experiment.yaml --socket joints < input 2> log &\n"
                          "until grep -q wrong_count log; do sleep 0.05; done\nkill -" +
                          signal + " $!; wait $!\n");
        const auto begun = std::chrono::steady_clock::now();
        EXPECT_EQ(WEXITSTATUS(std::system(("timeout 20 bash " + script.string()).c_str())), 0);
        EXPECT_LT(std::chrono::steady_clock::now() - begun, 15s);
        const std::string log = testing_support::ScratchFolder::read(folder / "log");
        EXPECT_NE(log.find("1 line sent, 0 lost, 1 refused"), std::string::npos) << log;
    }
}

/// More lines at once than the rig's rate lets through: those are no better than the ones before them.
TEST(JointsCommand, says_at_the_end_that_there_was_no_bus_whatever_the_rate_of_the_lines) {
    const std::string command =
        "yes '0 0 0 -1 0 1 0' | head -n 100 | " OCTOSKIN_PROGRAM
        " joints --can nocan9 --rig " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml 2> /dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 69);
}

/// `octoskin joints --can`, whose input the test writes while it reads what the command sends.
class ForwardedJoints {
  public:
    explicit ForwardedJoints(const std::string& rig = OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml") {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()), 0);
        command_end_ = ends[1];
        bus_.emplace("bus", ends[0]);
        const std::string command = OCTOSKIN_PROGRAM " joints --can fd:" + std::to_string(command_end_) +
                                    " --rig " + rig + " 2> " + (folder_ / "log").string();
        input_ = ::popen(command.c_str(), "w");
    }
    ~ForwardedJoints() {
        (void)end();
        ::close(command_end_);
    }
    ForwardedJoints(const ForwardedJoints&) = delete;
    ForwardedJoints& operator=(const ForwardedJoints&) = delete;

    /// The command reads `lines`, shorter than a page, in one piece.
    void write(const std::string& lines) {
        EXPECT_GE(std::fputs(lines.c_str(), input_), 0);
        EXPECT_EQ(std::fflush(input_), 0);
    }
    /// The first joint, in microradians, of the next sample; none after `patience`.
    [[nodiscard]] std::optional<std::int32_t> next(std::chrono::milliseconds patience) {
        const auto sample = next_of_all(patience);
        return sample ? std::optional(sample->second) : std::nullopt;
    }
    /// The same, and the node of its source.
    [[nodiscard]] std::optional<std::pair<wire::NodeId, std::int32_t>> next_of_all(
        std::chrono::milliseconds patience) {
        const auto end = std::chrono::steady_clock::now() + patience;
        while (true) {
            const auto received = bus_->receive();
            if (!received) return std::nullopt;
            if (*received) {
                const auto decoded = wire::decode((*received)->entry.frame);
                const auto* const state =
                    decoded ? std::get_if<wire::JointState>(&decoded->message) : nullptr;
                const auto* const pair = state != nullptr ? std::get_if<wire::JointPair>(state) : nullptr;
                if (pair != nullptr && pair->index == 0) return {{decoded->node_id, pair->position_urad[0]}};
                continue;
            }
            const auto left =
                std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
            pollfd readable{bus_->descriptor(), POLLIN, 0};
            if (left <= 0ms || ::poll(&readable, 1, static_cast<int>(left.count())) <= 0) return std::nullopt;
        }
    }
    [[nodiscard]] std::string log() const { return testing_support::ScratchFolder::read(folder_ / "log"); }
    /// Ends the input. The command's exit code.
    int end() { return input_ == nullptr ? -1 : WEXITSTATUS(::pclose(std::exchange(input_, nullptr))); }

  private:
    testing_support::ScratchFolder folder_;
    int command_end_ = -1;
    std::optional<socketcan::CanSocket> bus_;
    std::FILE* input_ = nullptr;
};

std::string joint_line(double first) {
    return std::to_string(first) + " 0 0 -1 0 1 0\n";
}

constexpr const char* kThreeSources =
    "extends: " OCTOSKIN_SOURCE_DIR
    "/hw/rigs/experiment.yaml\n"
    "joints:\n"
    "  - {node_id: 40, rate_hz: 100, names: [panda_joint1, panda_joint2, panda_joint3, panda_joint4]}\n"
    "  - {node_id: 41, rate_hz: 15, names: [panda_joint5, panda_joint6]}\n"
    "  - {node_id: 42, rate_hz: 15, names: [panda_joint7]}\n";

/// Of lines that were held up the oldest is where the arm was. The gap before a block begins when the sample
/// before it is on the bus, so that a slow command does not shorten it.
TEST(JointsCommand, sends_of_a_block_of_lines_without_a_time_the_newest_alone) {
    ForwardedJoints joints;
    joints.write(joint_line(0));
    ASSERT_EQ(joints.next(20s), 0);
    for (int block = 0; block < 2; ++block) {
        std::this_thread::sleep_for(300ms);
        joints.write(joint_line(0.1) + joint_line(0.2) + joint_line(0.3));
        ASSERT_EQ(joints.next(20s), 300'000);
    }
    EXPECT_EQ(joints.end(), 0);
    EXPECT_EQ(joints.next(0ms), std::nullopt);
    EXPECT_NE(joints.log().find("3 lines sent, 0 lost, 0 refused, 4 thinned"), std::string::npos)
        << joints.log();
}

/// Lines of several sources that come at once are no burst of any of them.
TEST(JointsCommand, sends_the_lines_of_each_source_that_come_with_those_of_another) {
    const testing_support::ScratchFolder folder;
    ForwardedJoints joints(folder.write("rig.yaml", kThreeSources).string());
    for (int pair = 0; pair < 3; ++pair) {
        joints.write("panda_joint5=0.1 panda_joint6=1.5\npanda_joint7=0.2\n");
        EXPECT_EQ(joints.next_of_all(20s), std::pair(wire::NodeId{41}, 100'000)) << pair;
        EXPECT_EQ(joints.next_of_all(20s), std::pair(wire::NodeId{42}, 200'000)) << pair;
        std::this_thread::sleep_for(300ms);
    }
    joints.write("panda_joint5=0.3 panda_joint6=1.5\npanda_joint7=0.4\npanda_joint5=0.5 panda_joint6=1.5\n");
    EXPECT_EQ(joints.next_of_all(20s), std::pair(wire::NodeId{42}, 400'000));
    EXPECT_EQ(joints.next_of_all(20s), std::pair(wire::NodeId{41}, 500'000)) << "the newest of its burst";
    EXPECT_EQ(joints.end(), 0);
    EXPECT_NE(joints.log().find("8 lines sent, 0 lost, 0 refused, 1 thinned"), std::string::npos)
        << joints.log();
}

/// The command runs when the times are read: they may be at most a second old.
TEST(JointsCommand, sends_each_line_of_a_block_that_has_a_time) {
    ForwardedJoints joints;
    joints.write(joint_line(0));
    ASSERT_EQ(joints.next(20s), 0);
    std::this_thread::sleep_for(200ms);
    const double now =
        std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    joints.write(std::to_string(now - 0.05) + " " + joint_line(0.1) + std::to_string(now) + " " +
                 joint_line(0.2));
    EXPECT_EQ(joints.next(20s), 100'000);
    EXPECT_EQ(joints.next(20s), 200'000);
    EXPECT_EQ(joints.end(), 0);
    EXPECT_EQ(joints.next(0ms), std::nullopt);
}

TEST(JointsCommand, refuses_lines_of_another_number_of_joints_wherever_they_go) {
    const testing_support::ScratchFolder folder;
    const Taker taker(folder / "joints");
    const std::string rig = " --rig " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml";
    for (const std::string& way : {"--can nocan9" + rig, "--socket " + (folder / "joints").string() + rig}) {
        const std::string command = "printf '1 2 3\\n1 2 3\\n' | " OCTOSKIN_PROGRAM " joints " + way +
                                    " 2> " + (folder / "log").string();
        EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 69) << way;
        const std::string log = testing_support::ScratchFolder::read(folder / "log");
        for (const char* const part :
             {"wrong_count: 3 numbers, the rig has 7 joints, found '1 2 3'", "[TIME] Q1 ... QN"})
            EXPECT_NE(log.find(part), std::string::npos) << part << "\n" << log;
    }
    EXPECT_FALSE(taker.gets_a_line(0ms));
}

/// Joint 4 of this arm cannot be stretched: the daemon would drop every such sample, where nobody sees it.
TEST(JointsCommand, refuses_lines_beyond_the_limits_of_the_rigs_robot_wherever_they_go) {
    const testing_support::ScratchFolder folder;
    const Taker taker(folder / "joints");
    const std::string rig = " --rig " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml";
    for (const std::string& way : {"--can nocan9" + rig, "--socket " + (folder / "joints").string() + rig}) {
        const std::string command = "printf '0 0 0 0 0 1 0\\n0 0 0 -0.06 0 1 0\\n' | " OCTOSKIN_PROGRAM
                                    " joints " +
                                    way + " 2> " + (folder / "log").string();
        EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 69) << way;
        const std::string log = testing_support::ScratchFolder::read(folder / "log");
        for (const char* const part : {"warning line not sent, out_of_limits: joint 4 of 7, panda_joint4: ",
                                       "-3.0718 to -0.0698", ", found 0", "0 0 0 0 0 1 0"})
            EXPECT_NE(log.find(part), std::string::npos) << part << "\n" << log;
        EXPECT_NE(log.find("2 refused"), std::string::npos) << log;
        EXPECT_EQ(log.find("warning line not sent"), log.rfind("warning line not sent"))
            << "once for each reason:\n"
            << log;
    }
    EXPECT_FALSE(taker.gets_a_line(0ms));
}

TEST(JointsCommand, takes_an_input_that_cannot_be_read_for_no_end_of_it) {
    const testing_support::ScratchFolder folder;
    const std::string command = "timeout 20 " OCTOSKIN_PROGRAM " joints --socket " +
                                (folder / "nobody").string() + " < " + folder.path().string() + " 2> " +
                                (folder / "log").string();
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 74);
    const std::string log = testing_support::ScratchFolder::read(folder / "log");
    EXPECT_NE(log.find("standard input: cannot be read: Is a directory"), std::string::npos) << log;
}

/// A descriptor that only shows an error must not keep the processor busy.
TEST(JointsCommand, rests_while_no_line_comes) {
    const testing_support::ScratchFolder folder;
    const std::string command =
        "sleep 2 | bash -c 'ulimit -t 1; exec " OCTOSKIN_PROGRAM
        " joints --can nocan9 --rig " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml' 2> /dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0);
}

}  // namespace
}  // namespace octoskin::test
