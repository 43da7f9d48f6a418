// That the maps are told when what goes into them was measured.
#include <gtest/gtest.h>

#include "host/core/pipeline/map_builder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

/// Where one kind of sensor has confirmed a voxel at this age.
std::size_t confirmed(const FusedMap& map, SensorKind kind, std::uint32_t age_s) {
    std::size_t voxels = 0;
    map.for_each_known([&](VoxelKey key, float) {
        voxels += map.confirmation(key) == Confirmation{age_s, kind} ? 1U : 0U;
    });
    return voxels;
}

class AgeWiring : public testing::Test {
  protected:
    MapBuilder build(const AgeModel& age) {
        MappingConfig mapping = plain_mapping();
        mapping.map.age = age;
        mapping.removes_robot_from_depth = false;
        return MapBuilder::build(one_joint_rig(), one_joint_robot(), mapping, {}, every_feed()).value();
    }
    static void read_at(MapBuilder& builder, double time_s) {
        const HostTime captured{static_cast<std::int64_t>(time_s * 1e9)};
        for (const std::int64_t beside_ns : {-5'000'000, 5'000'000}) {
            JointMeasurement joints{HostTime{captured.ns + beside_ns}, {}};
            joints.position_rad[0] = 1.57;
            ASSERT_TRUE(builder.add(joints));
        }
        ASSERT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, captured, 0.52, 0.01}));
    }
};

TEST_F(AgeWiring, tells_the_maps_the_times_of_readings_and_images) {
    MapBuilder builder = build({});
    ASSERT_TRUE(builder.integrate(flat_frame(3.5)));
    read_at(builder, 10.5);
    EXPECT_GT(confirmed(builder.map(), SensorKind::camera, 7), 100U);
    EXPECT_GT(confirmed(builder.map(), SensorKind::range, 0), 5U);
    EXPECT_GT(confirmed(builder.map(MapFeed::camera), SensorKind::camera, 7), 100U);
    EXPECT_GT(confirmed(builder.map(MapFeed::ranges), SensorKind::range, 0), 5U);
}

TEST_F(AgeWiring, forgets_what_no_sensor_has_confirmed) {
    MapBuilder builder = build({.stale_after_s = 2, .unknown_after_s = 5});
    ASSERT_TRUE(builder.integrate(flat_frame(3.5)));
    read_at(builder, 7.9);
    EXPECT_GT(builder.map().known_voxels(), builder.map(MapFeed::ranges).known_voxels());
    read_at(builder, 8.1);
    EXPECT_EQ(builder.map().known_voxels(), builder.map(MapFeed::ranges).known_voxels());
    EXPECT_GT(builder.map(MapFeed::ranges).known_voxels(), 0U);
}

TEST_F(AgeWiring, grows_older_while_a_saved_map_waits_and_says_so_to_a_listener) {
    class Waits final : public CommitListener {
      public:
        void on_joints(const JointMeasurement&) override {}
        void on_reading(const RangeMeasurement&, const Beam&, std::span<const VoxelUpdate>) override {}
        void on_depth(const DepthFrame&, const Evidence&) override {}
        void on_wait(const WaitCommit& passed) override { seconds.push_back(passed.seconds); }
        std::vector<std::int64_t> seconds;
    };
    MapBuilder builder = build({.stale_after_s = 20, .unknown_after_s = 0});
    ASSERT_TRUE(builder.integrate(flat_frame(3.5)));
    MapState saved = builder.state();
    saved.map.begin_to_wait();
    EXPECT_EQ(builder.begin_with(std::move(saved)), MapBuilder::LeftOut{});
    Waits waits;
    builder.set_listener(&waits);
    for (const std::int64_t seconds : {0, 1, 1, 4}) builder.wait(seconds);
    EXPECT_GT(confirmed(builder.map(), SensorKind::camera, 4), 100U);
    read_at(builder, 100.0);
    builder.wait(9);
    EXPECT_EQ(waits.seconds, (std::vector<std::int64_t>{1, 4}));
}

}  // namespace
}  // namespace octoskin::test
