// The depth camera beside a bus that is alive, and without it.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>

#include "host/apps/daemon/unix_socket.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr std::array<wire::NodeId, 3> kAllNodes = {1, 2, 3};

/// An arm at rest, which tells so a hundred times a second.
class JointFeeder {
  public:
    explicit JointFeeder(const std::filesystem::path& file)
        : socket_(connect_unix_socket(file, SOCK_DGRAM).value()), thread_([this](const std::stop_token& end) {
              constexpr std::string_view kAtRest = "0 0 0 -1.5 0 1.5 0";
              while (!end.stop_requested()) {
                  (void)::send(socket_, kAtRest.data(), kAtRest.size(), MSG_NOSIGNAL);
                  std::this_thread::sleep_for(10ms);
              }
          }) {}
    ~JointFeeder() {
        thread_ = {};  // ended and joined before its socket goes
        ::close(socket_);
    }
    JointFeeder(const JointFeeder&) = delete;
    JointFeeder& operator=(const JointFeeder&) = delete;

  private:
    int socket_;
    std::jthread thread_;
};

TEST_F(DaemonTest, takes_the_frames_of_a_camera_and_goes_on_without_it) {
    const auto wall = record_wall(folder_);
    start({"--camera", wall.string()});
    const auto took = daemon_->wait_until(
        [](const Json& status) { return status["inputs"]["depth frames"]["used"].get<int>() >= 5; }, 15s);
    ASSERT_TRUE(took) << daemon_->status()["inputs"].dump(1) << daemon_->log();
    const Json status = daemon_->status();
    EXPECT_TRUE(status["cameras"][0]["open"].get<bool>());
    // The first ones come before there is a pose.
    for (const auto& [reason, count] : status["inputs"]["depth frames"]["rejected"].items()) {
        const bool is_of_start = reason == "joints_missing" || reason == "outside_marks";
        EXPECT_TRUE(is_of_start || reason == "queue_overflow") << reason << ": " << count;
    }
    EXPECT_GT(status["map"]["known_voxels"].get<int>(), 100'000);

    std::filesystem::remove(wall);
    const std::string helper = "pkill -KILL -f '[o]ctoskin-film " + wall.string() + "'";
    ASSERT_EQ(std::system(helper.c_str()), 0);
    const auto reported =
        daemon_->wait_until([](const Json& now) { return has_problem(now, "camera:"); }, 3s);
    ASSERT_TRUE(reported);
    EXPECT_LE(*reported, 1s);
    const auto used = [](const Json& now) { return now["inputs"]["readings"]["used"].get<int>(); };
    const int before = used(daemon_->status());
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) > before; }, 2s)) << "they stand";
    (void)record_wall(folder_);
    const auto back = daemon_->wait_until(
        [](const Json& now) { return now.value(Json::json_pointer("/cameras/0/open"), false); }, 10s);
    ASSERT_TRUE(back) << daemon_->log();
    std::printf("named %ld ms after it was gone, back %ld ms after it was there again\n",
                static_cast<long>(reported->count()), static_cast<long>(back->count()));
    EXPECT_LE(*back, 5s);
}

TEST_F(DaemonTest, says_that_the_bus_is_silent_when_it_cannot_use_the_camera_for_that) {
    start({"--camera", record_wall(folder_, 24).string()});
    const auto used = [](const Json& now) { return now["inputs"]["depth frames"]["used"].get<int>(); };
    ASSERT_TRUE(
        daemon_->wait_until([&](const Json& now) { return used(now) >= 5 && now["problems"].empty(); }, 20s))
        << daemon_->status()["inputs"].dump(1) << daemon_->log();
    for (const wire::NodeId node : kAllNodes) bus_->silence(node, true);
    const auto reported =
        daemon_->wait_until([](const Json& now) { return has_problem(now, "camera_bus_silent"); }, 5s);
    ASSERT_TRUE(reported) << daemon_->status()["problems"].dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "depth_stopped"));
    const auto is_reported = daemon_->wait_until(
        [](const Json& now) {
            return now["inputs"]["depth frames"]["rejected"].value("joints_missing", 0) >= 20;
        },
        5s);
    EXPECT_TRUE(is_reported) << daemon_->status()["inputs"]["depth frames"].dump(1);
    const int used_then = used(daemon_->status());
    for (const wire::NodeId node : kAllNodes) bus_->silence(node, false);
    const auto back = daemon_->wait_until(
        [&](const Json& now) { return used(now) > used_then + 5 && !has_problem(now, "camera_bus_silent"); },
        10s);
    EXPECT_TRUE(back) << daemon_->status()["problems"].dump(1) << daemon_->status()["inputs"].dump(1);
}

TEST_F(DaemonTest, goes_on_with_a_camera_that_sees_no_robot_when_the_bus_falls_silent) {
    const auto file = folder_.write("mapping.yaml", "base: robust\nremoves_robot_from_depth: false\n");
    start({"--camera", record_wall(folder_, 24).string(), "--configuration", file.string()});
    const auto used = [](const Json& now) { return now["inputs"]["depth frames"]["used"].get<int>(); };
    ASSERT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) >= 5 && is_ranging(now); }, 20s))
        << daemon_->status()["inputs"].dump(1) << daemon_->log();
    for (const wire::NodeId node : kAllNodes) bus_->silence(node, true);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return has_problem(now, "node 1"); }, 5s));
    const int used_then = used(daemon_->status());
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) > used_then + 30; }, 15s))
        << daemon_->status()["inputs"].dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "camera: "));
}

// All that is measured then is dated by this machine's clock.
TEST_F(DaemonTest, goes_on_with_camera_and_joint_socket_when_the_adapter_is_gone) {
    start({"--camera", record_wall(folder_, 24).string(), "--joints", (folder_ / "joints").string()});
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const JointFeeder joints(daemon_->joints());
    const auto used = [](const Json& now) { return now["inputs"]["depth frames"]["used"].get<int>(); };
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) >= 5; }, 20s))
        << daemon_->status()["inputs"].dump(1) << daemon_->log();
    bus_.reset();
    our_end_ = -1;
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["can"]["state"] == "absent"; }, 3s));
    // Ten images a second; a node's clock is trusted for 5 s after its last exchange.
    const int used_then = used(daemon_->status());
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) > used_then + 80; }, 30s))
        << daemon_->status()["inputs"].dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "time_unknown"));
    EXPECT_LT(daemon_->status()["cameras"][0]["untimed"].get<int>(), 12)
        << "four at first; the film began anew four times since, and its time went on";
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

// The camera is shown a wall 3 m away where the sensors see the experiment's shelves: it sees through them.
TEST_F(DaemonTest, tells_of_each_sensor_what_the_camera_says_of_its_ranges) {
    start({"--camera", record_wall(folder_).string()});
    const auto contradicted = [](const Json& status) {
        for (const Json& node : status["nodes"]) {
            for (const Json& sensor : node["sensors"])
                if (sensor.value(Json::json_pointer("/camera/in_free_space"), 0) > 0) return true;
        }
        return false;
    };
    ASSERT_TRUE(daemon_->wait_until(contradicted, 30s))
        << daemon_->status()["nodes"].dump(1) << daemon_->log();
    const Json status = daemon_->status();
    for (const Json& node : status["nodes"]) {
        for (const Json& sensor : node["sensors"]) {
            const std::string name = sensor["name"].get<std::string>();
            const bool is_reported = std::ranges::any_of(status["problems"], [&](const Json& problem) {
                return problem["code"] == "sensor_contradicts_camera" &&
                       problem["on"].get<std::string>().ends_with(" '" + name + "'");
            });
            EXPECT_EQ(is_reported, sensor["camera"]["contradicts"].get<bool>()) << name;
        }
    }
}

}  // namespace
}  // namespace octoskin::test
