// Two programs that send joint states to one daemon: none of what they say moves the map while both are
// heard.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <string>
#include <thread>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/daemon_client.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/orderlog/order_reader.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"
#include "tests/system/said.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using testing_support::ScratchFolder;

/// A process of its own that tells one posture, again and again, until it goes.
class Driver {
  public:
    Driver(const std::filesystem::path& file, std::string posture, double hz, bool is_stamped)
        : child_(::fork()) {
        if (child_ != 0) return;
        const auto socket = connect_unix_socket(file, SOCK_DGRAM);
        while (socket) {
            const std::string line =
                is_stamped ? fmt::format("{:.6f} {}", 1e-9 * static_cast<double>(monotonic_now().ns), posture)
                           : posture;
            (void)::send(*socket, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
            std::this_thread::sleep_for(std::chrono::duration<double>(1.0 / hz));
        }
        ::_exit(1);
    }
    ~Driver() {
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
    Driver(const Driver&) = delete;
    Driver& operator=(const Driver&) = delete;
    [[nodiscard]] pid_t process() const noexcept { return child_; }

  private:
    pid_t child_;
};

const std::string kTrue = "0 -0.785 0 -2.356 0 1.571 0.785";
const std::string kFar = "1.0 -0.2 0.3 -1.5 0.4 1.2 0.1";
const std::string kClose = "0.03 -0.785 0 -2.356 0 1.571 0.785";  // what the arm may move in 10 ms

struct Pair {
    std::string name;
    std::string other;
    double hz = 100.0;
    double other_hz = 100.0;
    bool is_stamped = true;
};

class JointSendersTest : public DaemonTest {
  protected:
    void begin() {
        start({"--no-camera", "--joints", (folder_ / "joints").string()});
        ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    }
    [[nodiscard]] std::string recording() const { return (folder_ / "recording").string(); }
    [[nodiscard]] Json ask(const std::string& line) const {
        return Json::parse(ask_daemon(folder_ / "control", line).value());
    }
    [[nodiscard]] int of_several() const {
        return daemon_->status()["joints_socket"]["second_sender"].get<int>();
    }
    /// Every joint sample that went into the map is of the first driver.
    void expect_first_posture_alone() const {
        auto order = orderlog::OrderReader::open(recording() + "/order.log");
        ASSERT_TRUE(order);
        int samples = 0;
        while (true) {  // ends with the file
            const auto commit = order->next();
            ASSERT_TRUE(commit);
            if (!*commit) break;
            const auto* const joints = std::get_if<JointMeasurement>(&**commit);
            if (joints == nullptr) continue;
            ++samples;
            EXPECT_NEAR(joints->position_rad[0], 0.0, 1e-5);
        }
        EXPECT_GT(samples, 10) << "those of the seconds in which one driver was heard";
    }
    void expect_own_map() const {
        const Said replay = octoskin("replay " + recording() + " --fused-only");
        EXPECT_EQ(replay.exit_code, 0) << replay.output;
        EXPECT_NE(replay.output.find("identical to the daemon's, byte for byte"), std::string::npos)
            << replay.output;
    }
};

TEST_F(JointSendersTest, of_which_there_are_two_move_nothing_are_named_within_a_second_and_replay_so) {
    begin();
    const Driver first(daemon_->joints(), kTrue, 100.0, true);
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "joint_senders"));
    ASSERT_TRUE(ask("record start 0 " + recording())["ok"].get<bool>());
    for (const Pair& pair :
         {Pair{"far, stamped", kFar, 100.0, 100.0, true}, Pair{"far, unstamped", kFar, 100.0, 50.0, false},
          Pair{"close, stamped", kClose, 100.0, 60.0, true}, Pair{"the same", kTrue, 100.0, 100.0, true}}) {
        SCOPED_TRACE(pair.name);
        const int before = of_several();
        {
            const Driver second(daemon_->joints(), pair.other, pair.other_hz, pair.is_stamped);
            const auto named = daemon_->wait_until(
                [&](const Json& status) {
                    return has_problem(status, "joint_senders") &&
                           has_problem(status, fmt::format("process {} ", first.process())) &&
                           has_problem(status, fmt::format("process {} ", second.process()));
                },
                5s);
            ASSERT_TRUE(named) << daemon_->status()["problems"].dump(1);
            EXPECT_LE(*named, 1s);
            EXPECT_EQ(daemon_->status()["joints_socket"]["senders"].size(), 2U);
            EXPECT_TRUE(daemon_->status()["joint_states"]["second_sender"].get<bool>());
            std::this_thread::sleep_for(700ms);  // what waited for its pose is given up
            const int used = readings_used(daemon_->status());
            std::this_thread::sleep_for(500ms);
            EXPECT_EQ(readings_used(daemon_->status()), used);
        }
        const int used = readings_used(daemon_->status());
        const auto back =
            daemon_->wait_until([&](const Json& now) { return readings_used(now) > used + 20; }, 5s);
        ASSERT_TRUE(back) << daemon_->status()["problems"].dump(1);
        EXPECT_LE(*back, 2s) << "one second, and the readings";
        EXPECT_GT(of_several(), before + 100);
    }
    ASSERT_TRUE(ask("record stop")["ok"].get<bool>());
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return status["recording"]["state"] == "ended"; }, 10s));
    expect_first_posture_alone();
    expect_own_map();
}

// The arm's last three joints are a source of their own, as those of a tool.
TEST_F(JointSendersTest, may_each_send_a_source_of_their_own_by_name) {
    const std::filesystem::path rig = folder_ / "rig.yaml";
    std::ofstream(rig)
        << "extends: " << kExperiment
        << "\njoints:\n"
           "  - {node_id: 3, rate_hz: 100, names: [panda_joint1, panda_joint2, panda_joint3, "
           "panda_joint4], via: socket}\n"
           "  - {node_id: 5, rate_hz: 100, names: [panda_joint5, panda_joint6, panda_joint7], via: "
           "socket}\n";
    const std::string arm = "lamp=3 panda_joint2=-0.785 panda_joint1=0 panda_joint4=-2.356 panda_joint3=0";
    const std::string tool = "panda_joint7=0.785 panda_joint6=1.571 panda_joint5=0";
    start({"--no-camera", "--joints", (folder_ / "joints").string()}, rig);
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const Driver first(daemon_->joints(), arm, 100.0, true);
    int arm_unknown = 0;  // at the start
    {
        const Driver second(daemon_->joints(), tool, 100.0, true);
        ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1) << daemon_->log();
        const Json status = daemon_->status();
        EXPECT_FALSE(has_problem(status, "joint")) << status["problems"].dump(1);
        EXPECT_EQ(status["joints_socket"]["senders"].size(), 2U);
        ASSERT_EQ(status["joint_states"]["sources"].size(), 2U);
        EXPECT_EQ(status["joint_states"]["sources"][1]["node_id"], 5);
        EXPECT_EQ(status["joint_states"]["sources"][1]["via"], "socket");
        EXPECT_LT(status["joint_states"]["sources"][1]["age_s"].get<double>(), 0.5);
        ASSERT_TRUE(ask("record start 0 " + recording())["ok"].get<bool>());
        arm_unknown = status["joint_states"]["sources"][0]["joints"][1]["poses_without"].get<int>();
        const int used = readings_used(status);
        ASSERT_TRUE(daemon_->wait_until([&](const Json& now) { return readings_used(now) > used + 20; }, 5s));
    }
    const auto named = daemon_->wait_until(
        [](const Json& status) { return has_problem(status, "no joint states of panda_joint5"); }, 5s);
    ASSERT_TRUE(named) << daemon_->status()["problems"].dump(1);
    EXPECT_LE(*named, 1s);
    const auto unplaced = [](const Json& status) {
        return status["joint_states"]["sources"][1]["joints"][1]["poses_without"].get<int>();
    };
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return unplaced(now) > 0; }, 5s));
    EXPECT_EQ(daemon_->status()["joint_states"]["sources"][0]["joints"][1]["poses_without"], arm_unknown);
    ASSERT_TRUE(ask("record stop")["ok"].get<bool>());
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return status["recording"]["state"] == "ended"; }, 10s));
    expect_own_map();
}

TEST_F(JointSendersTest, of_which_one_takes_the_others_place_cost_a_second) {
    begin();
    {
        const Driver first(daemon_->joints(), kTrue, 100.0, true);
        ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1);
    }
    const Driver again(daemon_->joints(), kTrue, 100.0, true);
    const int used = readings_used(daemon_->status());
    const auto back =
        daemon_->wait_until([&](const Json& now) { return readings_used(now) > used + 20; }, 5s);
    ASSERT_TRUE(back) << daemon_->status()["problems"].dump(1);
    EXPECT_GE(*back, 500ms);
    EXPECT_LE(*back, 2s);
}

TEST_F(JointSendersTest, that_are_quicker_than_the_rig_are_told_and_used) {
    begin();
    const Driver quick(daemon_->joints(), kTrue, 1'000.0, false);
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1);
    const Json status = daemon_->status();
    EXPECT_TRUE(status["joints_socket"]["above_rate"].get<bool>()) << status["joints_socket"].dump(1);
    EXPECT_GT(status["joints_socket"]["rate_hz"].get<double>(), 130.0);
    EXPECT_FALSE(has_problem(status, "joint"));
    const Said said = octoskin("status --socket " + (folder_ / "control").string());
    EXPECT_NE(said.output.find("the surplus is left out"), std::string::npos) << said.output;
}

}  // namespace
}  // namespace octoskin::test
