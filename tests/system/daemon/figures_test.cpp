// What the daemon costs and how quick it is with all that a rig may have: 34 sensors at 50 Hz on one bus. Its
// figures are worth something on a machine that does nothing else.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

rig::Rig rig_at_50_hz() {
    rig::Rig rig = rig::read_rig(kExperiment).value();
    rig.name = "34_sensors_at_50_hz";
    for (rig::Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.config.sensor_count; ++i) {
            SensorConfig& sensor = node.config.sensors[i];
            sensor.phase_us = static_cast<std::uint16_t>(sensor.phase_us * 20U / sensor.inter_measurement_ms);
            sensor.distance_mode = DistanceMode::short_range;
            sensor.timing_budget_ms = 15;
            sensor.inter_measurement_ms = 20;
        }
    }
    return rig;
}

/// Of a process, user's and kernel's: proc(5).
double processor_seconds(pid_t process) {
    std::ifstream file("/proc/" + std::to_string(process) + "/stat");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::istringstream fields(text.substr(text.rfind(')') + 1));
    constexpr int kFieldsBetween = 11;  // from the state to what comes before utime
    std::string skipped;
    for (int i = 0; i < kFieldsBetween; ++i) fields >> skipped;
    double user = 0;
    double kernel = 0;
    fields >> user >> kernel;
    return (user + kernel) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

std::chrono::seconds duration() {
    const char* const reported = std::getenv("OCTOSKIN_FIGURES_SECONDS");
    return std::chrono::seconds(reported != nullptr ? std::atoi(reported) : 5);
}

class DaemonFigures : public DaemonTest {
  protected:
    /// Prints what was measured; the share of a core that the daemon took.
    double measure(const std::vector<std::string>& more_arguments, const char* what) {
        const rig::Rig rig = rig_at_50_hz();
        const auto file = folder_.write("rig.yaml", rig::canonical_text(rig, rig.urdf.shown().string()));
        start(more_arguments, file, make_log(rig::read_rig(file).value()));
        EXPECT_TRUE(daemon_->wait_until(is_ranging, 15s)) << daemon_->status().dump(1) << daemon_->log();
        const Json before = daemon_->status();
        const double processor_before_s = processor_seconds(daemon_->process());
        const auto begun = Clock::now();
        std::this_thread::sleep_for(duration());
        const double processor_s = processor_seconds(daemon_->process()) - processor_before_s;
        const Json after = daemon_->status();
        const double took_s = std::chrono::duration<double>(Clock::now() - begun).count();

        const auto grown = [&](const char* unit, const char* count) {
            return after["inputs"][unit][count].get<double>() - before["inputs"][unit][count].get<double>();
        };
        double clock_error_ms = 0;
        // It may be in doubt just now: nobody stamps the echo of our own SYNC on this bus, and its nodes are
        // a thread of a machine that is busy.
        for (const Json& node : after["nodes"]) {
            if (node["clock_known"].get<bool>())
                clock_error_ms = std::max(clock_error_ms, node["clock_error_ms"].get<double>());
        }
        std::printf(
            "34 sensors at 50 Hz, %s, %.1f s: %.0f readings/s came, %.0f/s onto the map, %.1f images/s; from "
            "frame to map %.2f ms median, %.2f ms 99 %%, %.2f ms at most; the daemon's processor time %.1f "
            "%% of "
            "a core; a node's time is off by %.2f ms at most, as the daemon tells\n",
            what, took_s, grown("readings", "in") / took_s, grown("readings", "used") / took_s,
            grown("depth frames", "used") / took_s, after["latency"]["median_ms"].get<double>(),
            after["latency"]["p99_ms"].get<double>(), after["latency"]["max_ms"].get<double>(),
            100.0 * processor_s / took_s, clock_error_ms);
        EXPECT_GT(grown("readings", "in"), 0.9 * 34 * 50 * took_s) << after["can"].dump();
        return processor_s / took_s;
    }
};

TEST_F(DaemonFigures, of_34_sensors_at_50_hz) {
    const double share = measure({"--no-camera"}, "no camera");
    EXPECT_GT(share, 0.0);
    EXPECT_LT(share, 1.0) << "2 to 3 % in a release build";
}

TEST_F(DaemonFigures, of_34_sensors_at_50_hz_and_a_camera) {
    (void)measure({"--camera", record_wall(folder_).string()}, "a camera of 512 x 424 at 10 Hz");
}

}  // namespace
}  // namespace octoskin::test
