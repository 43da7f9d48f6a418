// The daemon as a process: how it begins, takes new settings and goes on after it was killed; and a second
// one.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "host/apps/daemon/unix_socket.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "tests/support/evidence.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

std::string rig_named(const std::string& name) {
    return "extends: " OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml\nname: " + name + "\n";
}

std::size_t lines_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
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

TEST_F(DaemonTest, warns_of_a_robot_without_a_body) {
    std::string robot = testing_support::ScratchFolder::read(OCTOSKIN_SOURCE_DIR "/hw/robots/panda.urdf");
    for (std::size_t at = 0; (at = robot.find("collision", at)) != std::string::npos;)
        robot.replace(at, std::string("collision").size(), "visual");
    start({"--no-camera", "--robot", folder_.write("bare.urdf", robot).string()});
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    EXPECT_NE(daemon_->log().find("no link at or below panda_link0 has a <collision>"), std::string::npos)
        << daemon_->log();
    EXPECT_NE(daemon_->log().find("panda_link2, panda_link3"), std::string::npos) << daemon_->log();
    const Json status = daemon_->status();
    EXPECT_EQ(status["links_unknown"], status["links_without_body"]);
    EXPECT_EQ(status["links_unknown"].size(), 7U) << "neither the base, nor the frame of link 5";
    EXPECT_TRUE(has_problem(status, "links_without_body")) << status["problems"].dump();
    EXPECT_TRUE(has_problem(status, "robot: panda_link1, ")) << status["problems"].dump();
}

/// Never into a folder that is not locked, and never over another map.
TEST_F(DaemonTest, saves_in_the_folder_that_it_holds_whatever_becomes_of_its_name) {
    start({"--no-camera", "--save-every", "1"});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto saved_beyond = [this](int saves) {
        return daemon_->wait_until(
            [saves](const Json& now) { return now["map"]["saved"].get<int>() > saves; }, 10s);
    };
    ASSERT_TRUE(saved_beyond(0)) << daemon_->log();
    std::filesystem::remove_all(daemon_->maps());
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return has_problem(now, "was removed"); }, 5s))
        << daemon_->status()["problems"].dump();
    // Made at once with a map in it: a folder that is empty for a moment would be taken.
    std::filesystem::create_directory(folder_ / "other");
    folder_.write("other/fused.ot", "another map");
    std::filesystem::rename(folder_ / "other", daemon_->maps());
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& now) { return has_problem(now, "is not overwritten"); }, 5s))
        << daemon_->status()["problems"].dump();
    std::this_thread::sleep_for(1500ms);
    EXPECT_EQ(testing_support::ScratchFolder::read(daemon_->maps() / "fused.ot"), "another map");
    EXPECT_FALSE(std::filesystem::exists(daemon_->maps() / "fused.bt"));
    std::filesystem::remove(daemon_->maps() / "fused.ot");
    const int saves = daemon_->status()["map"]["saved"].get<int>();
    ASSERT_TRUE(saved_beyond(saves)) << daemon_->status()["problems"].dump();
    EXPECT_TRUE(load_map(daemon_->maps() / "fused.ot")) << "saved in the folder that was made anew";
    EXPECT_EQ(daemon_->status()["problems"], Json::array());
    const SilentBus other_bus;
    RunningDaemon second(folder_, other_bus.end_of_daemon(),
                         {"--no-camera", "--socket", (folder_ / "second").string()});
    EXPECT_EQ(second.wait(5s), 73) << "it is locked: " << second.log();
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

TEST_F(DaemonTest, reloads_all_or_nothing) {
    const auto rig_file = folder_.write("rig.yaml", rig_named("first"));
    start({"--no-camera"}, rig_file);
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    EXPECT_EQ(daemon_->status()["rig"], "first");
    const auto voxels = daemon_->status()["map"]["known_voxels"].get<int>();
    folder_.write("rig.yaml", rig_named("second"));
    EXPECT_EQ(daemon_->status()["reloads"]["count"], 0);
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& status) { return status["rig"] == "second"; }, 5s))
        << daemon_->log();
    EXPECT_GE(daemon_->status()["map"]["known_voxels"].get<int>(), voxels) << "the map did not go on";
    EXPECT_EQ(daemon_->status()["reloads"]["count"], 1);
    EXPECT_LT(daemon_->status()["reloads"]["dropped"].get<int>(), 20) << "more than what can wait";

    folder_.write("rig.yaml", "extends: nowhere.yaml\nname: third\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return has_problem(status, "reload_refused"); }, 10s))
        << daemon_->log();
    EXPECT_EQ(daemon_->status()["rig"], "second");
    EXPECT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const std::string log = daemon_->log();
    const auto reported = log.find("expected the path of a file");
    EXPECT_NE(reported, std::string::npos) << log;
    EXPECT_EQ(log.find("expected the path of a file", reported + 1), std::string::npos) << "twice:\n" << log;
}

/// What the nodes and the clock told is learnt anew, which takes a while: nothing is wrong meanwhile.
TEST_F(DaemonTest, names_nothing_as_missing_because_it_was_reloaded) {
    const auto rig_file = folder_.write("rig.yaml", rig_named("first"));
    // Longer than the test lasts on a busy machine: joints that jump are named, reload or not.
    start({"--no-camera"}, rig_file, make_log(rig::read_rig(rig_file).value(), 3));
    const auto is_well = [](const Json& now) { return is_ranging(now) && now["problems"].empty(); };
    ASSERT_TRUE(daemon_->wait_until(is_well, 15s)) << daemon_->log();
    std::this_thread::sleep_for(2500ms);  // what was missing at the start is over
    bus_->silence(1, true);
    // Alone: what a busy machine made late before the reload would be called over after it.
    const auto misses_only_that_node = [](const Json& now) {
        return has_problem(now, "node 1 ") && now["problems"].size() == 1;
    };
    ASSERT_TRUE(daemon_->wait_until(misses_only_that_node, 15s)) << daemon_->log();
    const auto before = daemon_->log().size();
    folder_.write("rig.yaml", rig_named("second"));
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return now["reloads"]["count"] == 1; }, 5s));
    std::this_thread::sleep_for(6s);
    const std::string log = daemon_->log().substr(before);
    EXPECT_NE(log.find("reloaded: rig"), std::string::npos) << log;
    for (const std::string untrue : {"node 2", "node 3", "joint states", "readings", "the time", "over: "})
        EXPECT_EQ(log.find(untrue), std::string::npos) << untrue << ":\n" << log;
    EXPECT_TRUE(has_problem(daemon_->status(), "node 1 ")) << daemon_->status()["problems"].dump(1);
}

/// Some 800 a second for 4 s, while the file says what it says, and once more as soon as it says something
/// else.
TEST_F(DaemonTest, maps_on_in_a_storm_of_sighup_and_obeys_the_last) {
    const auto rig_file = folder_.write("rig.yaml", rig_named("first"));
    start({"--no-camera"}, rig_file);
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const Json before = daemon_->status();
    const auto log_before = daemon_->log().size();
    const auto storm = [this](std::chrono::milliseconds duration) {
        const auto end = std::chrono::steady_clock::now() + duration;
        for (; std::chrono::steady_clock::now() < end; std::this_thread::sleep_for(1ms))
            daemon_->signal(SIGHUP);
    };
    storm(4s);
    const Json after = daemon_->status();
    ASSERT_TRUE(after.is_object()) << "no answer";
    EXPECT_LE(after["reloads"]["unchanged"].get<int>(), 6);
    EXPECT_GE(after["reloads"]["unchanged"].get<int>(), 1);
    EXPECT_EQ(after["reloads"]["count"], 0);
    // 68 sensors of this rig at 30 Hz, of which many hit something: 4 s have thousands.
    const auto in_of = [](const Json& now) { return now["inputs"]["readings"]["in"].get<int>(); };
    const int came = in_of(after) - in_of(before);
    EXPECT_GT(came, 500);
    EXPECT_GT(readings_used(after) - readings_used(before), 0.2 * came) << after["inputs"]["readings"];
    folder_.write("rig.yaml", rig_named("second"));
    storm(100ms);
    EXPECT_TRUE(daemon_->wait_until([](const Json& now) { return now["rig"] == "second"; }, 10s));
    EXPECT_LE(lines_of(daemon_->log().substr(log_before)), 20U) << daemon_->log();
}

TEST_F(DaemonTest, is_not_ended_by_signals_that_mean_nothing_to_it) {
    start();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    for (const int signal : {SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGIO, SIGPWR, SIGSTKFLT, SIGPIPE,
                             SIGXFSZ, SIGTRAP, SIGSYS, SIGRTMIN, SIGRTMAX - 1, SIGRTMAX}) {
        daemon_->signal(signal);
        EXPECT_FALSE(daemon_->wait(20ms)) << signal;
    }
    EXPECT_TRUE(daemon_->status().is_object());
    daemon_->signal(SIGQUIT);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
    EXPECT_TRUE(std::filesystem::exists(daemon_->maps() / "fused.ot")) << "ended without a save";
}

TEST_F(DaemonTest, saves_its_map_when_its_processor_time_is_over_and_says_so) {
    start();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    daemon_->signal(SIGXCPU);
    EXPECT_EQ(daemon_->wait(5s), 71) << daemon_->log();
    EXPECT_TRUE(std::filesystem::exists(daemon_->maps() / "fused.ot"));
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

TEST_F(DaemonTest, refuses_a_reload_that_has_too_little_memory_for_its_map) {
    FusedMap map{MapConfig{}};  // counts as 4096 bricks of 2064 bytes
    ASSERT_TRUE(map.set_cube({.lowest = {0, 0, 0}, .height = 7}, 1.0F));
    std::filesystem::create_directory(folder_ / "maps");
    ASSERT_TRUE(save_map(map, folder_ / "maps" / "fused.ot"));
    const auto file = folder_.write("mapping.yaml", "base: robust\n");
    start({"--no-camera", "--configuration", file.string()});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    folder_.write("mapping.yaml", "base: robust\nmap:\n  memory_max_mib: 4\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(daemon_->wait_until([](const Json& now) { return has_problem(now, "reload_refused"); }, 5s))
        << daemon_->log();
    const Json status = daemon_->status();
    EXPECT_TRUE(has_problem(status, "map.memory_max_mib: ")) << status["problems"].dump();
    EXPECT_TRUE(has_problem(status, "found 4: ")) << status["problems"].dump();
    EXPECT_EQ(status["reloads"]["count"], 0);
    EXPECT_NE(status["map"]["memory_max_mib"], 4);
    EXPECT_GE(status["map"]["known_voxels"].get<std::size_t>(), map.known_voxels());
    EXPECT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
}

TEST_F(DaemonTest, refuses_a_reload_with_another_resolution_and_keeps_the_map) {
    const auto file = folder_.write("mapping.yaml", "base: robust\n");
    start({"--no-camera", "--configuration", file.string(), "--save-every", "1"});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto voxels = daemon_->status()["map"]["known_voxels"].get<int>();
    ASSERT_GT(voxels, 0);
    folder_.write("mapping.yaml", "base: robust\nmap: {resolution_m: 0.02}\n");
    daemon_->signal(SIGHUP);
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return has_problem(status, "reload_refused"); }, 5s))
        << daemon_->log();
    EXPECT_TRUE(has_problem(daemon_->status(), "fused.ot: ")) << daemon_->status()["problems"].dump();
    EXPECT_TRUE(has_problem(daemon_->status(), "found 0.040000 m: ")) << daemon_->status()["problems"].dump();
    EXPECT_TRUE(has_problem(daemon_->status(), "move fused.ot, fused.bt and fused.snapshot away"));
    EXPECT_GE(daemon_->status()["map"]["known_voxels"].get<int>(), voxels) << "the map did not go on";
    EXPECT_EQ(daemon_->status()["reloads"]["count"], 0);
}

/// What systemd would have of it (sd_notify(3)).
class ServiceManager {
  public:
    explicit ServiceManager(const std::filesystem::path& file)
        : socket_(bind_unix_socket(file, SOCK_DGRAM)->descriptor) {
        ::setenv("NOTIFY_SOCKET", file.c_str(), 1);
        ::setenv("WATCHDOG_USEC", "400000", 1);
    }
    ~ServiceManager() {
        ::unsetenv("NOTIFY_SOCKET");
        ::unsetenv("WATCHDOG_USEC");
        ::close(socket_);
    }
    ServiceManager(const ServiceManager&) = delete;
    ServiceManager& operator=(const ServiceManager&) = delete;
    /// Reads on until it is told so.
    [[nodiscard]] bool is_reported(const std::string& what, std::chrono::milliseconds patience) const {
        const auto end = std::chrono::steady_clock::now() + patience;
        while (std::chrono::steady_clock::now() < end) {
            pollfd readable{socket_, POLLIN, 0};
            std::array<char, 1024> text{};
            if (::poll(&readable, 1, 50) <= 0) continue;
            const ssize_t count = ::recv(socket_, text.data(), text.size(), 0);
            if (count > 0 && std::string_view(text.data(), static_cast<std::size_t>(count)).find(what) !=
                                 std::string::npos)
                return true;
        }
        return false;
    }

  private:
    int socket_;
};

TEST_F(DaemonTest, tells_its_service_manager_of_readiness_life_reloads_and_its_end) {
    const ServiceManager manager(folder_ / "notify");
    start();
    EXPECT_TRUE(manager.is_reported("EXTEND_TIMEOUT_USEC=90000000", 10s))
        << "more with a large map" << daemon_->log();
    EXPECT_TRUE(manager.is_reported("READY=1", 10s)) << daemon_->log();
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(manager.is_reported("WATCHDOG=1", 400ms)) << "it would be killed";
    daemon_->signal(SIGHUP);
    EXPECT_TRUE(manager.is_reported("RELOADING=1", 2s));
    EXPECT_TRUE(manager.is_reported("READY=1", 2s));
    daemon_->signal(SIGTERM);
    EXPECT_TRUE(manager.is_reported("STOPPING=1", 2s));
    EXPECT_EQ(daemon_->wait(5s), 0);
}

TEST_F(DaemonTest, refuses_a_second_one_on_the_same_maps_and_names_the_first) {
    start();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const SilentBus other_bus;
    RunningDaemon second(folder_, other_bus.end_of_daemon(),
                         {"--no-camera", "--socket", (folder_ / "other").string()});
    EXPECT_EQ(second.wait(5s), 73) << second.log();
    EXPECT_NE(second.log().find("another octoskin (process " + std::to_string(daemon_->process()) + ")"),
              std::string::npos)
        << second.log();
    EXPECT_TRUE(daemon_->status().is_object());
}

TEST_F(DaemonTest, refuses_a_second_one_on_the_same_socket_and_names_the_first) {
    start();
    ASSERT_TRUE(daemon_->wait_until([](const Json&) { return true; }, 5s)) << daemon_->log();
    const SilentBus other_bus;
    RunningDaemon second(folder_, other_bus.end_of_daemon());
    EXPECT_EQ(second.wait(5s), 73) << second.log();
    EXPECT_NE(second.log().find("another octoskin (process " + std::to_string(daemon_->process()) +
                                ") has this socket"),
              std::string::npos)
        << second.log();
    EXPECT_TRUE(daemon_->status().is_object()) << "the first one lost its socket";
}

TEST_F(DaemonTest, goes_on_with_the_saved_map_after_it_was_killed) {
    start({"--no-camera", "--save-every", "1"});
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    ASSERT_TRUE(
        daemon_->wait_until([](const Json& status) { return status["map"]["saved"].get<int>() >= 2; }, 10s));
    daemon_->signal(SIGKILL);
    EXPECT_EQ(daemon_->wait(5s), -SIGKILL);
    const auto map = load_map(daemon_->maps() / "fused.ot");
    ASSERT_TRUE(map) << map.error().message();
    const SilentBus other_bus;
    daemon_.emplace(folder_, other_bus.end_of_daemon(), std::vector<std::string>{"--no-camera"});
    const auto up = daemon_->wait_until(
        [&](const Json& status) {
            return status["map"]["known_voxels"].get<std::size_t>() >= map->map.known_voxels();
        },
        5s);
    ASSERT_TRUE(up) << daemon_->log();
    EXPECT_LE(*up, 3s);
}

TEST_F(DaemonTest, goes_on_with_a_bt_that_is_alone_in_its_folder_and_saves_what_it_began_with) {
    FusedMap map(MapConfig{});
    for (std::uint16_t i = 0; i < 40; ++i) {
        const VoxelUpdate update{{static_cast<std::uint16_t>(20'000 + 3 * i), 20'000, 20'000}, 0.9F};
        feed(map, std::span(&update, 1));
    }
    std::filesystem::create_directories(folder_ / "maps");
    ASSERT_TRUE(save_map(map, folder_ / "maps" / "fused.bt"));
    start({"--no-camera", "--save-every", "1"});
    const auto is_saved = [](const Json& status) { return status["map"]["saved"].get<int>() >= 2; };
    ASSERT_TRUE(daemon_->wait_until(is_saved, 10s)) << daemon_->log();
    for (const char* file : {"fused.ot", "fused.bt"}) {
        const auto saved = load_map(daemon_->maps() / file);
        ASSERT_TRUE(saved) << saved.error().message();
        EXPECT_EQ(saved->map.log_odds({20'000, 20'000, 20'000}), 3.5F) << file;
        EXPECT_EQ(saved->map.log_odds({20'117, 20'000, 20'000}), 3.5F) << file;
    }
}

}  // namespace
}  // namespace octoskin::test
