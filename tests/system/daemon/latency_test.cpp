// How soon a reading is on the map: what docs/results.md promises, measured where nothing else is tested
// beside it.
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <thread>

#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;

constexpr double kMedianMaxMs = 1.0;
constexpr double kP99MaxMs = 5.0;
constexpr int kReadingsMin = 1'000;

struct Latency {
    int readings = 0;
    double median_ms = 0.0;
    double p99_ms = 0.0;
    [[nodiscard]] bool is_as_promised() const {
        return readings > kReadingsMin && median_ms <= kMedianMaxMs && p99_ms <= kP99MaxMs;
    }
};

/// Of a daemon that lives for some seconds on a bus that is alive.
Latency measure() {
    const testing_support::ScratchFolder folder;
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    const RunningDaemon daemon(folder, ends[0], {"--no-camera"});
    const LiveBus bus(ends[1], log_of_experiment());
    const auto has_some = [](const nlohmann::json& status) {
        return status["account"]["readings"]["used"].get<int>() > 100;
    };
    EXPECT_TRUE(daemon.wait_until(has_some, 15s)) << daemon.log();
    std::this_thread::sleep_for(4s);
    const auto latency = daemon.status()["latency"];
    return {latency["readings"].get<int>(), latency["median_ms"].get<double>(),
            latency["p99_ms"].get<double>()};
}

/// The best of three: other programs of this machine may want the processor, too, and a defect of ours is
/// there each time.
TEST(DaemonLatency, is_1_ms_in_the_median_and_5_ms_for_99_of_100_readings) {
    constexpr int kTries = 3;
    Latency latency;
    for (int i = 0; i < kTries && !latency.is_as_promised(); ++i) {
        latency = measure();
        std::printf("%d readings, from frame to map %.2f ms median, %.2f ms 99 %%\n", latency.readings,
                    latency.median_ms, latency.p99_ms);
    }
    EXPECT_GT(latency.readings, kReadingsMin);
    EXPECT_LE(latency.median_ms, kMedianMaxMs);
    EXPECT_LE(latency.p99_ms, kP99MaxMs);
}

}  // namespace
}  // namespace octoskin::test
