// Whose ranges are counted as a cone's: those of a sensor that sees one, where the mapping says so.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "host/core/pipeline/map_builder.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "tests/support/evidence.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

Scene scene_of(RangeUpdate update, BeamOptics optics) {
    Scene scene = good_scene();
    scene.depth.resize(1);
    scene.mapping.range_update = update;
    for (HostNode& node : scene.rig.nodes) {
        for (HostSensor& sensor : node.sensors) sensor.zones.front().optics = optics;
    }
    return scene;
}

constexpr BeamOptics kCone{.half_angle_rad = 0.24, .sigma_rad = 0.12};

TEST(ConeWiring, changes_nothing_for_sensors_that_are_rays) {
    EXPECT_TRUE(run(scene_of(RangeUpdate::cone, {})).has_equal_maps(run(scene_of(RangeUpdate::ray, {}))));
}

TEST(ConeWiring, takes_a_cone_for_a_ray_where_the_mapping_says_so) {
    EXPECT_TRUE(run(scene_of(RangeUpdate::ray, kCone)).has_equal_maps(run(scene_of(RangeUpdate::ray, {}))));
}

TEST(ConeWiring, counts_in_the_maps_that_range_sensors_make_and_gives_the_same_bytes_each_time) {
    const Scene scene = scene_of(RangeUpdate::cone, kCone);
    const RunResult as_cone = run(scene);
    EXPECT_TRUE(as_cone.has_equal_maps(run(scene)));
    const RunResult as_ray = run(scene_of(RangeUpdate::ray, kCone));
    EXPECT_EQ(as_cone.depth_ot, as_ray.depth_ot);
    EXPECT_NE(as_cone.proximity_ot, as_ray.proximity_ot);
    EXPECT_NE(as_cone.fused_ot, as_ray.fused_ot);
    EXPECT_EQ(as_cone.inputs.readings.used(), as_ray.inputs.readings.used());
}

TEST(ConeWiring, counts_zones_with_parameters_of_their_own) {
    BeamOptics zone = kCone;
    zone.is_zone = true;
    Scene as_zone = scene_of(RangeUpdate::cone, zone);
    EXPECT_NE(run(as_zone).fused_ot, run(scene_of(RangeUpdate::cone, kCone)).fused_ot);
    as_zone.mapping.zone = as_zone.mapping.cone;
    EXPECT_TRUE(run(as_zone).has_equal_maps(run(scene_of(RangeUpdate::cone, kCone))));
}

/// Of the voxels whose log-odds changed, what the listener was told, and what the map says.
class Changes final : public CommitListener {
  public:
    void on_joints(const JointMeasurement&) override {}
    void on_depth(const DepthFrame&, const Evidence&) override {}
    void on_reading(const RangeMeasurement&, const Beam&, std::span<const VoxelUpdate> updates) override {
        for (const VoxelUpdate& update : updates) {
            EXPECT_TRUE(reported_now_.insert(update.key).second) << "each voxel once";
            reported_[update.key] += update.log_odds;
        }
        reported_now_.clear();
    }
    void on_maps(std::span<const FedMap> maps) override {
        find_map(maps, MapFeed::both)->for_each_known([&](VoxelKey key, float log_odds) {
            EXPECT_NEAR(reported_[key], log_odds, 1e-4);
        });
    }

  private:
    std::set<VoxelKey> reported_now_;
    std::map<VoxelKey, float> reported_;
};

/// The arm stands, and its sensor is a cone.
class StandingCone : public testing::Test {
  protected:
    StandingCone() {
        Scene scene = scene_of(RangeUpdate::cone, kCone);
        scene.mapping.standing = fast_mapping().standing;
        builder_.emplace(
            MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, {}, every_feed()).value());
        builder_->set_listener(&changes_);
    }
    void read(std::optional<double> range_m, int times, double period_s = 0.033) {
        for (int i = 0; i < times; ++i) {
            now_s_ += period_s;
            for (const double beside_s : {-0.01, 0.01})
                ASSERT_TRUE(builder_->add({host_at(now_s_ + beside_s), {M_PI / 2.0}}));
            ASSERT_TRUE(
                builder_->integrate(RangeMeasurement{{kLeft, kGood, 0}, host_at(now_s_), range_m, 0.01}));
        }
    }
    [[nodiscard]] std::size_t occupied() const {
        std::size_t voxels = 0;
        const FusedMap& map = builder_->map();
        map.for_each_known([&](VoxelKey, float log_odds) {
            voxels += map.occupancy_of(log_odds) == Occupancy::occupied ? 1U : 0U;
        });
        return voxels;
    }
    std::optional<MapBuilder> builder_;
    Changes changes_;
    double now_s_ = 1.0;
};

TEST_F(StandingCone, has_what_comes_on_the_map_with_the_fourth_reading) {
    read(1.0, 30);
    EXPECT_EQ(occupied(), 0U);
    read(0.5, 3);
    EXPECT_EQ(occupied(), 0U);
    read(0.5, 1);
    EXPECT_GE(occupied(), 1U);
    EXPECT_LE(occupied(), 4U) << "the middle of its cap alone";
    read(1.0, 30);
    EXPECT_EQ(occupied(), 0U) << "and off it within a second of its having gone";
}

// However often it is said from one place, nothing tells where in the cap it is: its edge, which the cone's
// core never passes, must not fill up.
TEST_F(StandingCone, has_all_that_has_gone_off_the_map_however_long_it_stood) {
    for (const double range_m : {0.3, 0.4, 0.5, 0.65}) {
        for (const int times : {30, 200, 1000}) {
            read(range_m + 0.8, 30);
            read(range_m, times);
            EXPECT_GE(occupied(), 1U);
            read(range_m + 0.8, 20);
            EXPECT_EQ(occupied(), 0U) << range_m << " m, " << times << " readings";
        }
    }
}

// As of another rig, or forged.
TEST_F(StandingCone, goes_on_with_readings_of_zones_alone_that_the_rig_has_so) {
    read(1.3, 30);
    using Change = std::function<void(Beam&)>;
    const auto left_out_of = [&](const Change& change_newest, const Change& change_passage) {
        MapState state = builder_->state();
        ZoneHistory& zone = state.histories.begin()->second.zones.begin()->second;
        change_newest(zone.newest.front().beam);
        change_passage(zone.passages.front().beam);
        const std::size_t left_out = builder_->begin_with(std::move(state)).zones;
        EXPECT_EQ(builder_->histories().size(), 1U - left_out);
        return left_out;
    };
    const Change nothing = [](Beam&) {};
    EXPECT_EQ(left_out_of(nothing, nothing), 0U);
    EXPECT_EQ(left_out_of([](Beam& beam) { beam.range_m = 1.2; }, nothing), 0U);
    for (const Change& change :
         {Change([](Beam& beam) { beam.optics.half_angle_rad = 0.78; }),
          Change([](Beam& beam) { beam.optics = {}; }), Change([](Beam& beam) { beam.source.zone = 7; })}) {
        EXPECT_EQ(left_out_of(change, nothing), 1U);
        read(1.3, 30);
        EXPECT_EQ(left_out_of(nothing, change), 1U);
        read(1.3, 30);
    }
}

// A table's edge, say, in the cap but not in the core.
TEST_F(StandingCone, has_what_comes_on_the_map_beside_what_it_never_passes) {
    read(1.3, 10);
    read(0.5, 30);
    const std::size_t hand = occupied();
    read(1.3, 30);
    ASSERT_EQ(occupied(), 0U);
    Scene scene = scene_of(RangeUpdate::cone, kCone);
    scene.mapping.standing = fast_mapping().standing;
    builder_.emplace(
        MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, {}, every_feed()).value());
    FusedMap with_edge(scene.mapping.map);
    const Eigen::Vector3d p_edge(0.13, 0.6, 0.02);
    feed(with_edge, std::vector<VoxelUpdate>{{*with_edge.key_of(p_edge), 3.0F}});
    builder_->begin_with(std::move(with_edge));
    read(1.3, 30);
    ASSERT_EQ(occupied(), 1U);
    read(0.5, 6);
    EXPECT_EQ(occupied(), 1U + hand);
}

/// It is in no recording: nothing may follow from it.
TEST_F(StandingCone, reads_nothing_from_a_range_that_leaves_the_octree) {
    read(1.0, 5);
    const auto readings = [&] { return builder_->histories().begin()->second.readings; };
    const std::uint64_t before = readings();
    for (const double beside_s : {0.09, 0.11})
        ASSERT_TRUE(builder_->add({host_at(now_s_ + beside_s), {M_PI / 2.0}}));
    const auto far = builder_->integrate({{kLeft, kGood, 0}, host_at(now_s_ + 0.1), 1e5, 0.01});
    ASSERT_FALSE(far);
    EXPECT_EQ(far.error(), ReadingReason::outside_map);
    EXPECT_EQ(readings(), before);
}

TEST_F(StandingCone, has_what_has_gone_off_the_map_with_the_third_reading_however_slow_they_come) {
    constexpr double kOfNineZones_s = 0.3;
    read(0.5, 30, kOfNineZones_s);
    ASSERT_GE(occupied(), 1U);
    read(1.0, 2, kOfNineZones_s);
    EXPECT_GE(occupied(), 1U);
    read(1.0, 1, kOfNineZones_s);
    EXPECT_EQ(occupied(), 0U);
}

TEST_F(StandingCone, sees_through_nothing_over_where_time_leaps) {
    constexpr double kOfNineZones_s = 0.3;
    read(0.5, 30, kOfNineZones_s);
    read(1.0, 2, kOfNineZones_s);
    builder_->clear_motion({});
    read(1.0, 2, kOfNineZones_s);
    EXPECT_GE(occupied(), 1U);
    read(1.0, 1, kOfNineZones_s);
    EXPECT_EQ(occupied(), 0U);
}

/// Two zones, side by side, whose cones overlap.
class StandingZones : public testing::Test {
  protected:
    StandingZones() {
        Scene scene =
            scene_of(RangeUpdate::cone, {.half_angle_rad = 0.15, .sigma_rad = 0.05, .is_zone = true});
        auto& zones = scene.rig.nodes.front().sensors.front().zones;
        zones.push_back(zones.front());
        zones.back().direction_sensor = Eigen::Vector3d(0.1, 0.0, 1.0).normalized();
        scene.mapping.standing = fast_mapping().standing;
        builder_.emplace(
            MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, {}, every_feed()).value());
    }
    /// Both, one after the other; the first may be silent.
    void read(std::optional<double> first_m, double second_m) {
        for (const std::uint8_t zone : {std::uint8_t{0}, std::uint8_t{1}}) {
            now_s_ += 0.15;
            for (const double beside_s : {-0.01, 0.01})
                ASSERT_TRUE(builder_->add({host_at(now_s_ + beside_s), {M_PI / 2.0}}));
            if (zone == 0 && !first_m) continue;
            ASSERT_TRUE(builder_->integrate(RangeMeasurement{
                {kLeft, kGood, zone}, host_at(now_s_), zone == 0 ? *first_m : second_m, 0.005}));
        }
    }
    /// Well before the wall.
    [[nodiscard]] bool has_hand(double before_m = 0.6) const {
        bool is_any = false;
        const FusedMap& map = builder_->map();
        map.for_each_known([&](VoxelKey key, float log_odds) {
            is_any = is_any || (map.occupancy_of(log_odds) == Occupancy::occupied &&
                                map.centre_of(key).norm() < before_m);
        });
        return is_any;
    }
    std::optional<MapBuilder> builder_;
    double now_s_ = 1.0;
};

TEST_F(StandingZones, keep_what_one_of_them_sees_and_the_other_looks_past) {
    for (int i = 0; i < 10; ++i) read(1.0, 1.0);
    for (int i = 0; i < 4; ++i) read(0.4, 1.0);
    for (int i = 0; i < 300; ++i) {
        EXPECT_TRUE(has_hand()) << i;
        read(0.4, 1.0);
    }
}

// Behind it there is nothing in reach: readings without a range do not come this far.
TEST_F(StandingZones, have_what_has_gone_off_the_map_though_the_one_that_saw_it_is_silent) {
    for (int i = 0; i < 10; ++i) read(1.0, 1.0);
    for (int i = 0; i < 8; ++i) read(0.4, 1.0);
    ASSERT_TRUE(has_hand());
    for (int i = 0; i < 20; ++i) read(std::nullopt, 1.0);
    EXPECT_FALSE(has_hand());
}

TEST_F(StandingZones, have_all_that_has_gone_off_the_map_however_long_it_stood) {
    for (int i = 0; i < 10; ++i) read(1.2, 1.2);
    for (int i = 0; i < 60; ++i) read(0.4, 0.4);
    ASSERT_TRUE(has_hand());
    for (int i = 0; i < 4; ++i) read(1.2, 1.2);
    EXPECT_FALSE(has_hand());
}

// Before the wall's voxels most of the cap is free: its few others, at the edge, would take all of the blame.
TEST_F(StandingZones, mark_nothing_that_they_could_not_free) {
    for (const double range_m : {0.4, 0.8, 1.0, 1.2}) {
        for (int i = 0; i < 20; ++i) read(range_m + 0.8, range_m + 0.8);
        EXPECT_FALSE(has_hand(range_m + 0.4));
        for (int i = 0; i < 20; ++i) read(range_m, range_m);
        EXPECT_TRUE(has_hand(range_m + 0.4));
        for (int i = 0; i < 5; ++i) read(range_m + 0.8, range_m + 0.8);
        EXPECT_FALSE(has_hand(range_m + 0.4)) << range_m;
    }
}

TEST_F(StandingZones, take_nothing_from_each_other) {
    for (int i = 0; i < 10; ++i) read(0.2, 1.0);
    ASSERT_TRUE(has_hand());
    for (int i = 0; i < 100; ++i) {
        read(0.2, i % 10 == 0 ? 0.9 : 1.0);
        EXPECT_TRUE(has_hand()) << i;
    }
    for (int i = 0; i < 4; ++i) read(1.0, 1.0);
    EXPECT_FALSE(has_hand()) << "it has gone";
}

TEST_F(StandingCone, forgets_what_it_was_told_where_time_leaps) {
    read(1.0, 30);
    read(0.5, 3);
    builder_->clear_motion({});
    read(0.5, 3);
    EXPECT_EQ(occupied(), 0U);
    read(0.5, 1);
    EXPECT_GE(occupied(), 1U);
}

}  // namespace
}  // namespace octoskin::test
