// The daemon as it is started beside a robot, on a bus that is alive: the sensor boards of the experiment,
// played in real time, which answer the daemon's own SYNC.
#include "tests/system/daemon/daemon_fixture.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/mapfile/map_file.hpp"

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

TEST_F(DaemonTest, maps_a_live_bus_says_how_quick_it_is_and_saves_at_the_end) {
    start();
    const auto took = daemon_->wait_until(is_ranging, 15s);
    ASSERT_TRUE(took) << daemon_->status().dump(1) << daemon_->log();
    std::this_thread::sleep_for(3s);
    const Json status = daemon_->status();
    EXPECT_TRUE(status["problems"].empty()) << status["problems"].dump(1);
    for (const auto& unit : status["account"]) EXPECT_TRUE(unit["balanced"].get<bool>()) << unit.dump();
    const auto readings = status["account"]["readings"];
    std::printf(
        "first 100 readings %ld ms after the start; %d readings on the map; from frame to map %.2f ms "
        "median, "
        "%.2f ms 99 %%, %.2f ms at most\n",
        static_cast<long>(took->count()), readings["used"].get<int>(),
        status["latency"]["median_ms"].get<double>(), status["latency"]["p99_ms"].get<double>(),
        status["latency"]["max_ms"].get<double>());
    EXPECT_GT(readings["used"].get<int>(), 1'000);
    EXPECT_LE(status["latency"]["median_ms"].get<double>(), 1.0);
    // 0.1 to 0.3 ms where nobody else is at work. A hundredth of the readings are those of 40 ms here: so
    // much a busy machine may hold the daemon up once; a loop that waits for anything, such as the disk, is
    // over it.
    EXPECT_LE(status["latency"]["p99_ms"].get<double>(), 20.0);
    EXPECT_GT(status["can"]["busy_s"].get<double>(), 0.05);
    EXPECT_LT(status["can"]["busy_s"].get<double>(), 0.7 * status["uptime_s"].get<double>());
    for (const auto& node : status["nodes"])
        EXPECT_LE(node["clock_error_ms"].get<double>(), 2.0) << node.dump();
    EXPECT_EQ(status["can"]["not_sent"].get<int>(), 0);
    EXPECT_GE(bus_->syncs_heard(), 4U);

    daemon_->signal(SIGTERM);
    const auto ended = daemon_->wait(5s);
    ASSERT_TRUE(ended) << "did not end within 5 s";
    EXPECT_EQ(*ended, 0) << daemon_->log();
    const auto map = load_map(daemon_->maps() / "fused.ot");
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_GE(map->known_voxels(), status["map"]["known_voxels"].get<std::size_t>());
    EXPECT_GT(map->known_voxels(), 500U);
}

TEST_F(DaemonTest, names_a_node_that_falls_silent_within_a_second_and_takes_it_back) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    bus_->silence(2, true);
    const auto lost =
        daemon_->wait_until([](const Json& status) { return has_problem(status, "node 2"); }, 3s);
    ASSERT_TRUE(lost);
    EXPECT_LE(*lost, 1s);
    bus_->silence(2, false);
    const auto back =
        daemon_->wait_until([](const Json& status) { return !has_problem(status, "node 2"); }, 5s);
    ASSERT_TRUE(back) << daemon_->status()["problems"].dump(1);
    std::printf("named %ld ms after it fell silent, taken back after %ld ms\n",
                static_cast<long>(lost->count()), static_cast<long>(back->count()));
}

TEST_F(DaemonTest, refuses_a_node_that_babbles_and_takes_it_back_while_the_other_goes_on) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto received = [](const Json& status, std::size_t node) {
        int readings = 0;
        for (const auto& sensor : status["nodes"][node]["sensors"]) readings += sensor["received"].get<int>();
        return readings;
    };
    bus_->let_babble(2);
    const auto told = daemon_->wait_until(
        [](const Json& status) {
            return status["nodes"][1]["verdict"] == "babbling" &&
                   has_problem(status, "node 2 'front_rings': babbling");
        },
        10s);
    ASSERT_TRUE(told) << daemon_->status()["problems"].dump(1);
    // Its readings are refused, and those of the other node go on the map.
    const Json then = daemon_->status();
    Json status;
    const auto went_on = daemon_->wait_until(
        [&](const Json& now) {
            status = now;
            const auto& readings = now["account"]["readings"];
            return received(now, 0) > received(then, 0) + 1'000 &&
                   readings["used"].get<int>() > then["account"]["readings"]["used"].get<int>() + 700 &&
                   readings["rejected"].value("node_babbling", 0) > 500;
        },
        15s);
    ASSERT_TRUE(went_on) << status["account"]["readings"].dump(1);
    EXPECT_FALSE(has_problem(status, "node 1 'rear_rings': babbling"));
    bus_->let_babble(std::nullopt);
    const auto back =
        daemon_->wait_until([](const Json& now) { return now["nodes"][1]["verdict"] == "usable"; }, 10s);
    ASSERT_TRUE(back) << daemon_->status()["problems"].dump(1);
    std::printf("refused %ld ms after it began, taken back %ld ms after it stopped\n",
                static_cast<long>(told->count()), static_cast<long>(back->count()));
    EXPECT_NE(daemon_->log().find("node 2 'front_rings': babbling (over "), std::string::npos)
        << daemon_->log();
}

// As long as the kernel keeps what comes: it is dated by its stamps, however late it is read.
TEST_F(DaemonTest, loses_nothing_of_the_bus_when_it_has_no_processor_for_half_a_second) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const Json before = daemon_->status();
    daemon_->signal(SIGSTOP);
    std::this_thread::sleep_for(500ms);
    daemon_->signal(SIGCONT);
    const Json after = daemon_->status();
    const auto used = [](const Json& now) { return now["account"]["readings"]["used"].get<int>(); };
    EXPECT_GT(used(after), used(before) + 300) << "at once: half of those of 34 sensors at 30 Hz are used";
    EXPECT_EQ(after["clock"], before["clock"]) << "no step of the clock";
    const auto rejected = [](const Json& now, const char* reason) {
        return now["account"]["readings"]["rejected"].value(reason, 0);
    };
    for (const char* reason : {"no_host_time", "too_old", "node_lost"})
        EXPECT_EQ(rejected(after, reason), rejected(before, reason)) << reason;
}

// Longer than the kernel keeps it.
TEST_F(DaemonTest, catches_up_with_the_bus_after_it_had_no_processor_for_two_seconds) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const Json before = daemon_->status();
    daemon_->signal(SIGSTOP);
    std::this_thread::sleep_for(2s);
    daemon_->signal(SIGCONT);
    const auto used = [](const Json& now) { return now["account"]["readings"]["used"].get<int>(); };
    const auto caught_up = daemon_->wait_until(
        [&](const Json& now) { return used(now) > used(before) + 1'000 && now["problems"].empty(); }, 15s);
    const Json status = daemon_->status();
    ASSERT_TRUE(caught_up) << status["problems"].dump(1) << status["account"].dump(1);
    std::printf("on the map as before %ld ms after it went on\n", static_cast<long>(caught_up->count()));
    for (const auto& unit : status["account"]) EXPECT_TRUE(unit["balanced"].get<bool>()) << unit.dump();
    EXPECT_EQ(status["clock"]["times_back"], 0);
}

TEST_F(DaemonTest, names_joint_states_that_stop) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    bus_->silence(3, true);
    const auto told = daemon_->wait_until(
        [](const Json& status) { return has_problem(status, "joint states have stopped"); }, 3s);
    ASSERT_TRUE(told) << daemon_->status()["problems"].dump(1);
    bus_->silence(3, false);
    EXPECT_TRUE(daemon_->wait_until([](const Json& status) { return status["problems"].empty(); }, 5s))
        << daemon_->status()["problems"].dump(1);
}

TEST_F(DaemonTest, transmits_nothing_when_it_only_listens_and_says_what_that_needs) {
    start({"--no-camera", "--listen-only"});
    std::this_thread::sleep_for(3s);
    const Json status = daemon_->status();
    ASSERT_TRUE(status.is_object()) << daemon_->log();
    EXPECT_EQ(bus_->frames_heard(), 0U);
    EXPECT_GT(status["can"]["received"].get<int>(), 100);
    EXPECT_TRUE(has_problem(status, "--listen-only")) << status["problems"].dump(1);
}

// Nobody tells the time; that the others are heard does.
TEST_F(DaemonTest, names_a_node_that_falls_silent_where_nobody_sends_sync) {
    start({"--no-camera", "--listen-only"});
    ASSERT_TRUE(daemon_->wait_until(
        [](const Json& now) {
            return now["nodes"][0]["verdict"] == "usable" && now["nodes"][1]["verdict"] == "usable";
        },
        15s))
        << daemon_->status()["nodes"].dump(1) << daemon_->log();
    bus_->silence(2, true);
    const auto told = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "node 2 'front_rings': lost"); }, 3s);
    ASSERT_TRUE(told) << daemon_->status()["problems"].dump(1);
    EXPECT_LE(*told, 1s);
    const Json status = daemon_->status();
    EXPECT_EQ(status["nodes"][0]["verdict"], "usable");
    EXPECT_FALSE(status["clock"]["known"].get<bool>());
    bus_->silence(2, false);
    EXPECT_TRUE(
        daemon_->wait_until([](const Json& now) { return now["nodes"][1]["verdict"] == "usable"; }, 3s))
        << daemon_->status()["problems"].dump(1);
}

// The other host booted a quarter of an hour before this one.
TEST_F(DaemonTest, listens_to_another_hosts_clock_and_puts_its_own_camera_on_it) {
    const auto wall = record_wall(folder_, 24);
    start({"--camera", wall.string(), "--listen-only"});
    bus_->speak_as_host(std::chrono::minutes(15));
    // Whenever the .oni begins anew, five frames without a time are a problem for half a second.
    Json status;
    const auto took = daemon_->wait_until(
        [&status](const Json& now) {
            status = now;
            return is_ranging(now) && now["account"]["depth frames"]["used"].get<int>() >= 5 &&
                   now["problems"].empty();
        },
        15s);
    ASSERT_TRUE(took) << status["problems"].dump(1) << status["account"].dump(1) << daemon_->log();
    EXPECT_LT(status["nodes"][0]["age_s"].get<double>(), 1.0);
    EXPECT_EQ(bus_->frames_heard(), 0U);

    // One wrong word of that host must not displace a single image: half a second looks plausible to every
    // gate.
    bus_->lie_once(std::chrono::milliseconds(-500));
    const auto noticed = daemon_->wait_until(
        [](const Json& now) { return now["clock"]["follow_up_outliers"].get<int>() == 1; }, 5s);
    ASSERT_TRUE(noticed) << daemon_->status()["clock"].dump();
    const int used = daemon_->status()["account"]["depth frames"]["used"].get<int>();
    const auto again = daemon_->wait_until(
        [&](const Json& now) { return now["account"]["depth frames"]["used"].get<int>() > used + 10; }, 10s);
    ASSERT_TRUE(again) << daemon_->status()["account"].dump(1);
    const Json rejected = daemon_->status()["account"]["depth frames"]["rejected"];
    EXPECT_EQ(rejected.count("out_of_order"), 0U) << rejected.dump();
    EXPECT_EQ(daemon_->status()["clock"]["follow_up_outliers"], 1);
}

// It hears them all the time; that their time is in doubt says nothing about them.
TEST_F(DaemonTest, calls_no_node_lost_while_another_hosts_clock_is_set) {
    start({"--no-camera", "--listen-only"});
    bus_->speak_as_host(std::chrono::minutes(15));
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& now) { return is_ranging(now) && now["problems"].empty(); }, 15s))
        << daemon_->status()["problems"].dump(1);
    const int relocks = daemon_->status()["clock"]["relocks"].get<int>();
    bus_->speak_as_host(std::chrono::minutes(16));
    Json lost;
    const auto over = daemon_->wait_until(
        [&](const Json& now) {
            if (has_problem(now, "lost")) lost = now;
            return now["clock"]["relocks"].get<int>() > relocks && now["problems"].empty();
        },
        20s);
    ASSERT_TRUE(over) << daemon_->status()["problems"].dump(1);
    EXPECT_TRUE(lost.is_null()) << lost["problems"].dump(1) << lost["clock"].dump(1);
}

TEST_F(DaemonTest, takes_joint_states_from_a_program_of_this_machine) {
    start({"--no-camera", "--joints", (folder_ / "joints").string()});  // the rig's joint node goes on, too
    // 100 samples a second, each sampled when it is written.
    const std::string command =
        "for i in $(seq 600); do echo 0 0 0 -1.5 0 1.5 0; sleep 0.01; done | " OCTOSKIN_PROGRAM
        " joints --socket " +
        daemon_->joints().string();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    std::thread forwarder([&] { EXPECT_EQ(std::system(command.c_str()), 0); });
    const auto took = daemon_->wait_until(
        [](const Json& status) {
            return is_ranging(status) && status["account"]["joint samples"]["used"].get<int>() > 50;
        },
        15s);
    EXPECT_TRUE(took) << daemon_->status().dump(1);
    const Json status = daemon_->status();
    EXPECT_GT(status["joints_socket"]["samples"].get<int>(), 50);
    EXPECT_GT(status["joints_socket"]["joint_node_ignored"].get<int>(), 100);
    EXPECT_EQ(status["account"]["joint samples"]["rejected"].count("contradictory"), 0U) << status.dump(1);
    EXPECT_LE(status["account"]["joint samples"]["in"].get<int>(),
              status["joints_socket"]["samples"].get<int>());
    forwarder.join();
}

TEST_F(DaemonTest, takes_the_frames_of_a_camera_and_goes_on_without_it) {
    const auto wall = record_wall(folder_);
    start({"--camera", wall.string()});
    const auto took = daemon_->wait_until(
        [](const Json& status) { return status["account"]["depth frames"]["used"].get<int>() >= 5; }, 15s);
    ASSERT_TRUE(took) << daemon_->status()["account"].dump(1) << daemon_->log();
    const Json status = daemon_->status();
    EXPECT_TRUE(status["camera"]["open"].get<bool>());
    // The first ones come before there is a pose.
    for (const auto& [reason, count] : status["account"]["depth frames"]["rejected"].items()) {
        const bool is_of_start = reason == "joints_missing" || reason == "outside_marks";
        EXPECT_TRUE(is_of_start || reason == "queue_overflow") << reason << ": " << count;
    }
    EXPECT_GT(status["map"]["known_voxels"].get<int>(), 100'000);

    std::filesystem::remove(wall);
    const std::string helper = "pkill -KILL -f '[o]ctoskin-camera " + wall.string() + "'";
    ASSERT_EQ(std::system(helper.c_str()), 0);
    const auto told = daemon_->wait_until([](const Json& now) { return has_problem(now, "camera:"); }, 3s);
    ASSERT_TRUE(told);
    EXPECT_LE(*told, 1s);
    const int used = daemon_->status()["account"]["readings"]["used"].get<int>();
    (void)record_wall(folder_);
    const auto back =
        daemon_->wait_until([](const Json& now) { return now["camera"]["open"].get<bool>(); }, 10s);
    ASSERT_TRUE(back) << daemon_->log();
    std::printf("named %ld ms after it was gone, back %ld ms after it was there again\n",
                static_cast<long>(told->count()), static_cast<long>(back->count()));
    EXPECT_LE(*back, 5s);
    EXPECT_GT(daemon_->status()["account"]["readings"]["used"].get<int>(), used) << "the ranges stood still";
}

TEST_F(DaemonTest, says_that_the_bus_is_silent_when_it_cannot_use_the_camera_for_that) {
    start({"--camera", record_wall(folder_, 24).string()});
    const auto used = [](const Json& now) { return now["account"]["depth frames"]["used"].get<int>(); };
    ASSERT_TRUE(
        daemon_->wait_until([&](const Json& now) { return used(now) >= 5 && now["problems"].empty(); }, 20s))
        << daemon_->status()["account"].dump(1) << daemon_->log();
    for (const wire::NodeId node : kAllNodes) bus_->silence(node, true);
    const auto told = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "not used, because the bus is silent"); }, 5s);
    ASSERT_TRUE(told) << daemon_->status()["problems"].dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "see the counters of depth frames"));
    const auto is_told = daemon_->wait_until(
        [](const Json& now) {
            return now["account"]["depth frames"]["rejected"].value("joints_missing", 0) >= 20;
        },
        5s);
    EXPECT_TRUE(is_told) << daemon_->status()["account"]["depth frames"].dump(1);
    const int used_then = used(daemon_->status());
    for (const wire::NodeId node : kAllNodes) bus_->silence(node, false);
    const auto back = daemon_->wait_until(
        [&](const Json& now) { return used(now) > used_then + 5 && !has_problem(now, "bus is silent"); },
        10s);
    EXPECT_TRUE(back) << daemon_->status()["problems"].dump(1) << daemon_->status()["account"].dump(1);
}

TEST_F(DaemonTest, goes_on_with_a_camera_that_sees_no_robot_when_the_bus_falls_silent) {
    const auto file = folder_.write("mapping.yaml", "base: robust\nremoves_robot_from_depth: false\n");
    start({"--camera", record_wall(folder_, 24).string(), "--configuration", file.string()});
    const auto used = [](const Json& now) { return now["account"]["depth frames"]["used"].get<int>(); };
    ASSERT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) >= 5 && is_ranging(now); }, 20s))
        << daemon_->status()["account"].dump(1) << daemon_->log();
    for (const wire::NodeId node : kAllNodes) bus_->silence(node, true);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return has_problem(now, "node 1"); }, 5s));
    const int used_then = used(daemon_->status());
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) > used_then + 30; }, 15s))
        << daemon_->status()["account"].dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "camera: "));
}

// All that is measured then is dated by this machine's clock.
TEST_F(DaemonTest, goes_on_with_camera_and_joint_socket_when_the_adapter_is_gone) {
    start({"--camera", record_wall(folder_, 24).string(), "--joints", (folder_ / "joints").string()});
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const JointFeeder joints(daemon_->joints());
    const auto used = [](const Json& now) { return now["account"]["depth frames"]["used"].get<int>(); };
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) >= 5; }, 20s))
        << daemon_->status()["account"].dump(1) << daemon_->log();
    bus_.reset();
    our_end_ = -1;
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["can"]["state"] == "absent"; }, 3s));
    // Ten images a second; a node's clock is trusted for 5 s after its last exchange.
    const int used_then = used(daemon_->status());
    EXPECT_TRUE(daemon_->wait_until([&](const Json& now) { return used(now) > used_then + 80; }, 30s))
        << daemon_->status()["account"].dump(1);
    EXPECT_FALSE(has_problem(daemon_->status(), "the time is not known"));
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

// The camera is shown a wall 3 m away where the sensors see the experiment's shelves: it sees through them.
TEST_F(DaemonTest, tells_of_each_sensor_what_the_camera_says_of_its_ranges) {
    start({"--camera", record_wall(folder_).string()});
    const auto contradicted = [](const Json& status) {
        for (const Json& node : status["nodes"]) {
            for (const Json& sensor : node["sensors"])
                if (sensor["camera"]["in_free_space"].get<int>() > 0) return true;
        }
        return false;
    };
    ASSERT_TRUE(daemon_->wait_until(contradicted, 30s))
        << daemon_->status()["nodes"].dump(1) << daemon_->log();
    const Json status = daemon_->status();
    for (const Json& node : status["nodes"]) {
        for (const Json& sensor : node["sensors"]) {
            const std::string words = sensor["name"].get<std::string>() + "': contradicts the camera";
            EXPECT_EQ(has_problem(status, words), sensor["camera"]["contradicts"].get<bool>()) << words;
        }
    }
}

TEST_F(DaemonTest, reloads_all_or_nothing) {
    const auto rig_file =
        folder_.write("rig.yaml", "extends: " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml\nname: first\n");
    start({"--no-camera"}, rig_file);
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    EXPECT_EQ(daemon_->status()["rig"], "first");
    const auto voxels = daemon_->status()["map"]["known_voxels"].get<int>();
    folder_.write("rig.yaml", "extends: " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml\nname: second\n");
    EXPECT_EQ(daemon_->status()["reloads"]["count"], 0);
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& status) { return status["rig"] == "second"; }, 5s))
        << daemon_->log();
    EXPECT_GE(daemon_->status()["map"]["known_voxels"].get<int>(), voxels) << "the map did not go on";
    EXPECT_EQ(daemon_->status()["reloads"]["count"], 1);
    EXPECT_LT(daemon_->status()["reloads"]["dropped"].get<int>(), 20) << "more than what can wait";

    folder_.write("rig.yaml", "extends: nowhere.yaml\nname: third\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until(
        [](const Json& status) { return has_problem(status, "the old settings hold"); }, 5s))
        << daemon_->log();
    EXPECT_EQ(daemon_->status()["rig"], "second");
    EXPECT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
}

TEST_F(DaemonTest, goes_on_with_its_map_when_a_reload_gives_it_more_memory) {
    const auto file = folder_.write("mapping.yaml", "base: robust\n");
    start({"--no-camera", "--configuration", file.string()});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto voxels = daemon_->status()["map"]["known_voxels"].get<int>();
    ASSERT_GT(voxels, 0);
    folder_.write("mapping.yaml", "base: robust\nmap:\n  memory_max_mib: 321\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return now["map"]["memory_max_mib"] == 321; }, 5s))
        << daemon_->log();
    EXPECT_GE(daemon_->status()["map"]["known_voxels"].get<int>(), voxels) << "the map did not go on";
}

TEST_F(DaemonTest, refuses_a_second_one_on_the_same_maps_and_names_the_first) {
    start();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    RunningDaemon second(folder_, ends[0], {"--no-camera", "--socket", (folder_ / "other").string()});
    EXPECT_EQ(second.wait(5s), 73) << second.log();
    EXPECT_NE(second.log().find("another octoskin (process " + std::to_string(daemon_->process()) + ")"),
              std::string::npos)
        << second.log();
    EXPECT_TRUE(daemon_->status().is_object());
    ::close(ends[1]);
}

TEST_F(DaemonTest, goes_on_with_the_saved_map_after_it_was_killed) {
    start({"--no-camera", "--save-every", "1"});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return status["map"]["saved"].get<int>() >= 2; }, 10s));
    daemon_->signal(SIGKILL);
    EXPECT_EQ(daemon_->wait(5s), -SIGKILL);
    const auto map = load_map(daemon_->maps() / "fused.ot");
    ASSERT_TRUE(map) << map.error().message;
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    daemon_.emplace(folder_, ends[0], std::vector<std::string>{"--no-camera"});
    const auto up = daemon_->wait_until(
        [&](const Json& status) {
            return status["map"]["known_voxels"].get<std::size_t>() >= map->known_voxels();
        },
        5s);
    ASSERT_TRUE(up) << daemon_->log();
    EXPECT_LE(*up, 3s);
    ::close(ends[1]);
}

TEST_F(DaemonTest, says_that_the_adapter_is_gone) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    bus_.reset();
    our_end_ = -1;
    const auto told =
        daemon_->wait_until([](const Json& status) { return status["can"]["state"] == "absent"; }, 3s);
    ASSERT_TRUE(told);
    EXPECT_LE(*told, 1s);
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

TEST_F(DaemonTest, refuses_a_rig_with_a_mistake_with_exit_code_78) {
    ::close(our_end_);
    folder_.write("rig.yaml", "name: 5\nbogus: 1\n");
    RunningDaemon daemon(folder_, its_end_, {}, folder_ / "rig.yaml");
    const auto ended = daemon.wait(5s);
    ASSERT_TRUE(ended);
    EXPECT_EQ(*ended, 78) << daemon.log();
    EXPECT_NE(daemon.log().find("rig.yaml:"), std::string::npos) << daemon.log();
}

TEST_F(DaemonTest, refuses_a_second_one_on_the_same_socket) {
    start();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    RunningDaemon second(folder_, ends[0]);
    EXPECT_EQ(second.wait(5s), 73) << second.log();
    EXPECT_NE(second.log().find("another octoskin"), std::string::npos);
    EXPECT_TRUE(daemon_->status().is_object()) << "the first one lost its socket";
    ::close(ends[1]);
}

}  // namespace
}  // namespace octoskin::test
