// A daemon that transmits nothing, beside another host or none.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

TEST_F(DaemonTest, transmits_nothing_when_it_only_listens_and_says_what_that_needs) {
    start({"--no-camera", "--listen-only"});
    std::this_thread::sleep_for(3s);
    const Json status = daemon_->status();
    ASSERT_TRUE(status.is_object()) << daemon_->log();
    EXPECT_EQ(bus_->frames_heard(), 0U);
    EXPECT_GT(status["can"]["received"].get<int>(), 100);
    EXPECT_TRUE(has_problem(status, "time_unknown") && has_problem(status, "--listen-only"))
        << status["problems"].dump(1);
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
    const auto reported = daemon_->wait_until(
        [](const Json& now) { return has_problem(now, "node 2 'front_rings': lost"); }, 3s);
    ASSERT_TRUE(reported) << daemon_->status()["problems"].dump(1);
    EXPECT_LE(*reported, 1s);
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
    Json status;
    const auto took = daemon_->wait_until(
        [&status](const Json& now) {
            status = now;
            return is_ranging(now) && now["inputs"]["depth frames"]["used"].get<int>() >= 5 &&
                   now["problems"].empty();
        },
        15s);
    ASSERT_TRUE(took) << status["problems"].dump(1) << status["inputs"].dump(1) << daemon_->log();
    EXPECT_LT(status["nodes"][0]["age_s"].get<double>(), 1.0);
    EXPECT_EQ(bus_->frames_heard(), 0U);

    // One wrong word of that host must not displace a single image: half a second looks plausible to every
    // gate.
    bus_->lie_once(std::chrono::milliseconds(-500));
    const auto noticed = daemon_->wait_until(
        [](const Json& now) { return now["clock"]["follow_up_outliers"].get<int>() == 1; }, 5s);
    ASSERT_TRUE(noticed) << daemon_->status()["clock"].dump();
    const int used = daemon_->status()["inputs"]["depth frames"]["used"].get<int>();
    const auto again = daemon_->wait_until(
        [&](const Json& now) { return now["inputs"]["depth frames"]["used"].get<int>() > used + 10; }, 10s);
    ASSERT_TRUE(again) << daemon_->status()["inputs"].dump(1);
    const Json rejected = daemon_->status()["inputs"]["depth frames"]["rejected"];
    EXPECT_EQ(rejected.count("out_of_order"), 0U) << rejected.dump();
    EXPECT_EQ(daemon_->status()["clock"]["follow_up_outliers"], 1);
}

// What it shows cannot be put on the time of a bus that nobody tells.
TEST_F(DaemonTest, counts_its_cameras_frames_as_untimed_until_somebody_tells_the_time) {
    start({"--camera", record_wall(folder_, 24).string(), "--listen-only"});
    const auto frames = [](const Json& now) { return now["cameras"][0]["frames"].get<int>(); };
    ASSERT_TRUE(daemon_->wait_until([&](const Json& now) { return frames(now) >= 20; }, 20s))
        << daemon_->status()["cameras"][0].dump() << daemon_->log();
    const Json unreported = daemon_->status();
    EXPECT_GE(unreported["cameras"][0]["untimed"].get<int>(), frames(unreported) - 3)
        << "what waits is not counted yet";
    EXPECT_EQ(unreported["inputs"]["depth frames"]["in"], 0);
    bus_->speak_as_host(std::chrono::minutes(15));
    EXPECT_TRUE(daemon_->wait_until(
        [](const Json& now) { return now["inputs"]["depth frames"]["in"].get<int>() >= 10; }, 30s))
        << daemon_->status()["cameras"][0].dump();
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
            // That it leapt is told for a minute, and nothing else.
            return now["clock"]["relocks"].get<int>() > relocks && now["problems"].size() == 1 &&
                   has_problem(now, "time_ahead");
        },
        20s);
    ASSERT_TRUE(over) << daemon_->status()["problems"].dump(1);
    EXPECT_TRUE(lost.is_null()) << lost["problems"].dump(1) << lost["clock"].dump(1);
}

}  // namespace
}  // namespace octoskin::test
