// The daemon as it is started beside a robot: what it makes of a bus that is alive, and how soon it says what
// is wrong with it.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "host/io/mapfile/map_file.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

TEST_F(DaemonTest, maps_a_live_bus_says_how_quick_it_is_and_saves_at_the_end) {
    start();
    const auto took = daemon_->wait_until(is_ranging, 15s);
    ASSERT_TRUE(took) << daemon_->status().dump(1) << daemon_->log();
    std::this_thread::sleep_for(3s);
    const Json status = daemon_->status();
    EXPECT_TRUE(status["problems"].empty()) << status["problems"].dump(1);
    for (const auto& unit : status["inputs"]) EXPECT_TRUE(unit["balanced"].get<bool>()) << unit.dump();
    const auto readings = status["inputs"]["readings"];
    std::printf(
        "first 100 readings %ld ms after the start; %d readings on the map; from frame to map %.2f ms "
        "median, "
        "%.2f ms 99 %%, %.2f ms at most\n",
        static_cast<long>(took->count()), readings["used"].get<int>(),
        status["latency"]["median_ms"].get<double>(), status["latency"]["p99_ms"].get<double>(),
        status["latency"]["max_ms"].get<double>());
    // The joint state behind a reading comes 5 ms after its capture, in the mean of a period, and is certain
    // 12.5 ms later; beside these 10 ms of the budget and the frame's 3 ms of company do not count.
    const double age_median_ms = status["latency"]["age_median_ms"].get<double>();
    std::printf("from capture to map %.1f ms median, %.1f ms 99 %%\n", age_median_ms,
                status["latency"]["age_p99_ms"].get<double>());
    EXPECT_GE(age_median_ms, 17.5);
    EXPECT_LE(age_median_ms, 40.0);
    EXPECT_GE(status["latency"]["age_p99_ms"].get<double>(), age_median_ms);
    EXPECT_GT(readings["used"].get<int>(), 1'000);
    EXPECT_LE(status["latency"]["median_ms"].get<double>(), 1.0);
    // 0.1 to 0.3 ms where nobody else is at work; latency_test.cpp holds it to 5 ms, alone. A hundredth of
    // the readings are those of 40 ms here: so much a busy machine may hold the daemon up once; a loop that
    // waits for anything, such as the disk, is over it.
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
    ASSERT_TRUE(map) << map.error().message();
    EXPECT_GE(map->map.known_voxels(), status["map"]["known_voxels"].get<std::size_t>());
    EXPECT_GT(map->map.known_voxels(), 500U);
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
    const auto reported = daemon_->wait_until(
        [](const Json& status) {
            return status["nodes"][1]["verdict"] == "babbling" &&
                   has_problem(status, "node 2 'front_rings': babbling");
        },
        10s);
    ASSERT_TRUE(reported) << daemon_->status()["problems"].dump(1);
    // Its readings are refused, and those of the other node go on the map.
    const Json then = daemon_->status();
    Json status;
    const auto went_on = daemon_->wait_until(
        [&](const Json& now) {
            status = now;
            const auto& readings = now["inputs"]["readings"];
            return received(now, 0) > received(then, 0) + 1'000 &&
                   readings["used"].get<int>() > then["inputs"]["readings"]["used"].get<int>() + 700 &&
                   readings["rejected"].value("node_babbling", 0) > 500;
        },
        15s);
    ASSERT_TRUE(went_on) << status["inputs"]["readings"].dump(1);
    EXPECT_FALSE(has_problem(status, "node 1 'rear_rings': babbling"));
    bus_->let_babble(std::nullopt);
    const auto back =
        daemon_->wait_until([](const Json& now) { return now["nodes"][1]["verdict"] == "usable"; }, 10s);
    ASSERT_TRUE(back) << daemon_->status()["problems"].dump(1);
    std::printf("refused %ld ms after it began, taken back %ld ms after it stopped\n",
                static_cast<long>(reported->count()), static_cast<long>(back->count()));
    EXPECT_NE(daemon_->log().find("node 2 'front_rings': babbling (over "), std::string::npos)
        << daemon_->log();
}

// As long as the kernel keeps what comes: it is dated by its stamps, however late it is read.
TEST_F(DaemonTest, loses_nothing_of_the_bus_when_it_has_no_processor_for_half_a_second) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto [before, after] = hold_up(500ms);
    EXPECT_GT(readings_used(after), readings_used(before) + 300)
        << "at once: half of those of 34 sensors at 30 Hz are used";
    EXPECT_EQ(after["clock"], before["clock"]) << "no step of the clock";
    const auto rejected = [](const Json& now, const char* reason) {
        return now["inputs"]["readings"]["rejected"].value(reason, 0);
    };
    for (const char* reason : {"no_host_time", "too_old", "node_lost"})
        EXPECT_EQ(rejected(after, reason), rejected(before, reason)) << reason;
}

// Longer than the kernel keeps it.
TEST_F(DaemonTest, catches_up_with_the_bus_after_it_had_no_processor_for_two_seconds) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const int used = readings_used(hold_up(2s).before);
    const auto caught_up = daemon_->wait_until(
        [&](const Json& now) { return readings_used(now) > used + 1'000 && now["problems"].empty(); }, 15s);
    const Json status = daemon_->status();
    ASSERT_TRUE(caught_up) << status["problems"].dump(1) << status["inputs"].dump(1);
    std::printf("on the map as before %ld ms after it went on\n", static_cast<long>(caught_up->count()));
    for (const auto& unit : status["inputs"]) EXPECT_TRUE(unit["balanced"].get<bool>()) << unit.dump();
    EXPECT_EQ(status["clock"]["times_back"], 0);
}

// Long enough for its time to be in doubt, and for its nodes to be lost.
TEST_F(DaemonTest, has_readings_on_the_map_within_a_second_after_the_bus_was_cut) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    const auto back_after = [&](std::chrono::milliseconds gap) {
        bus_->cut(true);
        std::this_thread::sleep_for(gap);
        const int used = readings_used(daemon_->status());
        bus_->cut(false);
        const auto back =
            daemon_->wait_until([&](const Json& now) { return readings_used(now) > used + 50; }, 5s);
        std::this_thread::sleep_for(1100ms);
        return back;
    };
    for (const auto gap : {500ms, 3000ms, 250ms, 700ms, 900ms}) {  // from several instants between two SYNCs
        // A machine that has no time for us is asked again: what is late of itself is late every time.
        auto back = back_after(gap);
        for (int i = 0; i < 2 && back && *back > 1s; ++i) back = back_after(gap);
        ASSERT_TRUE(back) << daemon_->status()["problems"].dump(1) << daemon_->status()["inputs"].dump(1);
        std::printf("on the map again %ld ms after a gap of %ld ms\n", static_cast<long>(back->count()),
                    static_cast<long>(gap.count()));
        EXPECT_LE(*back, 1s) << gap.count() << " ms";
    }
}

TEST_F(DaemonTest, names_joint_states_that_stop) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    bus_->silence(3, true);
    const auto reported =
        daemon_->wait_until([](const Json& status) { return has_problem(status, "joints_stopped"); }, 3s);
    ASSERT_TRUE(reported) << daemon_->status()["problems"].dump(1);
    bus_->silence(3, false);
    EXPECT_TRUE(daemon_->wait_until([](const Json& status) { return status["problems"].empty(); }, 5s))
        << daemon_->status()["problems"].dump(1);
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
            return is_ranging(status) && status["inputs"]["joint samples"]["used"].get<int>() > 50;
        },
        15s);
    EXPECT_TRUE(took) << daemon_->status().dump(1);
    const Json status = daemon_->status();
    EXPECT_GT(status["joints_socket"]["samples"].get<int>(), 50);
    EXPECT_GT(status["joints_socket"]["joint_node_ignored"].get<int>(), 100);
    EXPECT_EQ(status["inputs"]["joint samples"]["rejected"].count("contradictory"), 0U) << status.dump(1);
    EXPECT_LE(status["inputs"]["joint samples"]["in"].get<int>(),
              status["joints_socket"]["samples"].get<int>());
    forwarder.join();
}

TEST_F(DaemonTest, says_that_the_adapter_is_gone) {
    start();
    ASSERT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->log();
    bus_.reset();
    our_end_ = -1;
    const auto reported =
        daemon_->wait_until([](const Json& status) { return status["can"]["state"] == "absent"; }, 3s);
    ASSERT_TRUE(reported);
    EXPECT_LE(*reported, 1s);
    daemon_->signal(SIGTERM);
    EXPECT_EQ(daemon_->wait(5s), 0) << daemon_->log();
}

}  // namespace
}  // namespace octoskin::test
