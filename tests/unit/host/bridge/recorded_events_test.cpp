// A recording as the events of a daemon.
#include "host/bridge/recorded/recorded_events.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "host/io/mapfile/map_file.hpp"

namespace octoskin::bridge {
namespace {

std::filesystem::path frozen(const char* name) {
    return std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/frozen" / name;
}

PlaybackRequest request(const char* name) {
    return {.recording = RecordingPaths(FilePlace(frozen(name))),
            .mapping = {},
            .configuration = "default",
            .rig = {},
            .robot = {}};
}

class Seen final : public DaemonListener, public RecordedDetails {
  public:
    void on_robot(RobotFacts facts) override {
        EXPECT_EQ(maps + ranges + joints, 0);
        robot = std::move(facts);
        ++robots;
    }
    void on_map(const watch::WatchedMap& map) override {
        ++maps;
        EXPECT_TRUE(map.is_whole());
        if (map_time && maps > 2) {
            least_period = std::min(least_period, last_period);
            last_period = map.time() - *map_time;
        }
        map_time = map.time();
        known = map.map().known_voxels();
    }
    void on_range(const watch::WatchedRange& range, HostTime captured) override {
        ++ranges;
        EXPECT_NE(robot.find_sensor(range.source.node_id, range.source.sensor), nullptr);
        EXPECT_LE(captured, now);
    }
    void on_joints(const watch::WatchedJoints& sample, HostTime) override {
        ++joints;
        EXPECT_EQ(sample.position.size(), robot.joint_sources.at(sample.source).joints.size());
    }
    void on_status(const nlohmann::ordered_json& status) override {
        ++statuses;
        problems = status.at("problems").size();
    }
    void on_lost(const std::string&) override { FAIL(); }
    void on_time(HostTime bus, WallTime wall) override {
        EXPECT_LE(now, bus);
        now = bus;
        offset = wall.ns - bus.ns;
        first = first.value_or(bus);
    }
    void on_depth(const DepthFrame& frame) override {
        ++frames;
        EXPECT_EQ(frame.depth_mm.size(), std::size_t{frame.width} * frame.height);
    }

    RobotFacts robot;
    int robots = 0, maps = 0, ranges = 0, joints = 0, statuses = 0, frames = 0;
    std::size_t problems = 0;
    std::size_t known = 0;
    std::optional<HostTime> map_time;
    Nanoseconds last_period{Nanoseconds::max()};
    Nanoseconds least_period{Nanoseconds::max()};
    HostTime now{0};
    std::optional<HostTime> first;
    std::int64_t offset = 0;
};

TEST(RecordedEvents, are_the_commits_of_a_daemons_recording) {
    auto events = RecordedEvents::open(request("daemon"));
    ASSERT_TRUE(events) << events.error().message();
    EXPECT_TRUE(events->has_wall_time());
    EXPECT_NE(events->robot_description().find("<robot"), std::string::npos);
    Seen seen;
    const auto played = events->play(seen, &seen);
    ASSERT_TRUE(played) << played.error().message();
    EXPECT_EQ(seen.robots, 1);
    EXPECT_EQ(seen.joints, 627);
    EXPECT_EQ(seen.ranges, 3841);
    EXPECT_EQ(seen.frames, 61);
    EXPECT_EQ(seen.statuses, 2);
    EXPECT_EQ(seen.problems, played->warnings.size());
    // Of the first line of can.log, (1795830121.768401), to the clock of SYNC, 3938.. s.
    EXPECT_NEAR(static_cast<double>(seen.offset) * 1e-9, 1'795'830'121.77 - 3'938.8, 1.0);
    EXPECT_EQ(seen.known, played->pipeline.map().known_voxels());
    // 6.3 s: at most ten maps a second, and the first and the last one.
    EXPECT_GE(seen.maps, 40);
    EXPECT_LE(seen.maps, 66);
    EXPECT_GE(seen.least_period, RecordedEvents::kMapPeriod);
}

TEST(RecordedEvents, come_at_the_requested_pace) {
    PlaybackRequest paced = request("daemon");
    paced.pace = Pace::times(10.0);
    auto events = RecordedEvents::open(std::move(paced));
    ASSERT_TRUE(events);
    Seen seen;
    const auto begun = std::chrono::steady_clock::now();
    ASSERT_TRUE(events->play(seen, &seen));
    EXPECT_GE(std::chrono::steady_clock::now() - begun, std::chrono::milliseconds(500));
}

TEST(RecordedEvents, refuse_a_folder_that_is_no_recording) {
    const auto events = RecordedEvents::open(request("none"));
    ASSERT_FALSE(events);
    EXPECT_EQ(events.error().exit, ExitCode::no_input);
}

}  // namespace
}  // namespace octoskin::bridge
