// One sensor that is looked at, three that show where the camera is, and walls, small enough to know by
// heart.
#include "host/core/cross_check/cross_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "host/core/kinematics/turned_z.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr BeamSource kSource{.node_id = 4, .sensor = 1, .zone = 0};

/// The camera is at the map's origin and looks along z, over x and y of as much as its depth; a second sensor
/// and two more are there.
HostRig rig() {
    HostRig rig;
    rig.nodes.emplace_back();
    rig.nodes.back().node_id = 4;
    rig.nodes.back().sensors.resize(4);
    rig.cameras = {HostCamera{}};
    rig.cameras.front().intrinsics = {.width = 100, .height = 100, .fx = 50, .fy = 50, .cx = 50, .cy = 50};
    return rig;
}

DepthImage wall_at(float depth_m) {
    return {.width = 100, .height = 100, .depth_m = std::vector<float>(100 * 100, depth_m)};
}

/// From (x, y, 1) along `direction`: a new place with each of 35 beams, 30 cm from the others.
Beam beam(int number, std::optional<double> range_m, const Eigen::Vector3d& direction = {0, 0, 1}) {
    return {.source = kSource,
            .captured = HostTime{100'000'000LL * number},
            .p_map_sensor = {-0.9 + 0.3 * (number % 7), -0.6 + 0.3 * (number / 7 % 5), 1.0},
            .direction_map = direction.normalized(),
            .range_m = range_m,
            .sigma_m = 0.02,
            .clear_limit_m = range_m ? 0.0 : 1.5};
}

/// Where a sensor is that makes such a beam.
Eigen::Isometry3d T_map_sensor_of(const Beam& beam) {
    Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
    T_map_sensor.translation() = beam.p_map_sensor;
    T_map_sensor.linear() = turned_z(beam.direction_map);
    return T_map_sensor;
}

void give(CrossCheck& cross_check, const Beam& beam) {
    cross_check.on_beam(beam, T_map_sensor_of(beam));
}

/// A corner of three walls: at z = 2 m, x = 0.9 m and y = 0.9 m.
double corner_m(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
    double range_m = (2.0 - from.z()) / direction.z();
    for (int i = 0; i < 2; ++i)
        if (direction[i] > 0.0) range_m = std::min(range_m, (0.9 - from[i]) / direction[i]);
    return range_m;
}

DepthImage corner() {
    DepthImage image = wall_at(2.0F);
    for (int v = 0; v < 100; ++v)
        for (int u = 0; u < 100; ++u)
            image.depth_m[static_cast<std::size_t>(v * 100 + u)] = static_cast<float>(
                corner_m({0, 0, 0}, {(u + 0.5 - 50.0) / 50.0, (v + 0.5 - 50.0) / 50.0, 1.0}));
    return image;
}

/// What the camera measured is what its filter makes of it.
SeenImages seen(const DepthImage& everything, const DepthImage& world) {
    SeenImages images{.everything = everything, .world = world, .certainty = {}};
    CertainPixels(rig().cameras.front().intrinsics, {}).find(everything, everything, images.certainty);
    return images;
}

void show(CrossCheck& cross_check, const DepthImage& everything, const DepthImage& world, HostTime captured) {
    SeenImages images = seen(everything, world);
    cross_check.on_depth(images, Eigen::Isometry3d::Identity(), captured);
    cross_check.settle();
}

class CrossCheckTest : public testing::Test {
  protected:
    /// Other sensors have ranged the corner where the camera has it.
    CrossCheckTest() { show_corner(cross_check_); }

    static void show_corner(CrossCheck& cross_check) {
        static const SeenImages kCorner = seen(corner(), corner());
        for (int i = 0; i < 200; ++i) {
            const HostTime captured{100'000'000LL * (i - 200)};
            for (const int sensor : {0, 2, 3}) {
                Beam other = beam(i + 5 * sensor, 1.0);
                other.source.sensor = static_cast<std::uint8_t>(sensor);
                other.captured = captured;
                other.p_map_sensor = {-0.3 + 0.05 * (i % 7), -0.3 + 0.07 * (i % 5), 0.7 + 0.1 * (i % 3)};
                other.direction_map =
                    Eigen::Vector3d(i % 3 == 0 ? 1.0 : 0.1, i % 3 == 1 ? 1.0 : 0.1, i % 3 == 2 ? 1.0 : 0.6)
                        .normalized();
                other.range_m = corner_m(other.p_map_sensor, other.direction_map);
                give(cross_check, other);
            }
            SeenImages images = kCorner;
            cross_check.on_depth(images, Eigen::Isometry3d::Identity(), captured);
            cross_check.settle();
        }
    }

    /// `count` beams like this, each with an image of its time.
    void compare(int count, std::optional<double> range_m, const DepthImage& image,
                 const Eigen::Vector3d& direction = {0, 0, 1}) {
        for (int i = 0; i < count; ++i) {
            ++number_;
            give(cross_check_, beam(number_, range_m, direction));
            show(cross_check_, image, image, HostTime{100'000'000LL * number_});
        }
    }
    const SensorEvidence& evidence() const { return cross_check_.evidence(4, 1); }
    std::uint64_t findings() const {
        return evidence().agreed + evidence().in_free_space + evidence().behind_surface;
    }

    CrossCheck cross_check_{rig(), {}};
    int number_ = 0;
};

TEST_F(CrossCheckTest, a_range_to_the_surface_that_the_camera_sees_agrees) {
    compare(5, 1.0, wall_at(2.0F));
    EXPECT_EQ(evidence().agreed, 5U);
    EXPECT_EQ(findings(), 5U);
    EXPECT_FALSE(evidence().contradicts());
}

// The bound is 3 (0.03 + 0.02) + 0.03 m = 0.18 m.
TEST_F(CrossCheckTest, a_range_that_ends_where_the_camera_sees_through_contradicts) {
    compare(3, 0.80, wall_at(2.0F));
    EXPECT_EQ(evidence().in_free_space, 3U);
    compare(3, 0.83, wall_at(2.0F));
    EXPECT_EQ(evidence().agreed, 3U);
}

TEST_F(CrossCheckTest, a_range_through_a_surface_that_the_camera_sees_contradicts) {
    compare(3, 1.30, wall_at(2.0F));
    EXPECT_EQ(evidence().behind_surface, 3U);
    compare(3, std::nullopt, wall_at(2.0F));  // free up to 1.5 m, it says
    EXPECT_EQ(evidence().behind_surface, 6U);
    compare(80, 0.55, wall_at(1.25F));
    EXPECT_TRUE(evidence().is_far_off);
}

TEST_F(CrossCheckTest, what_the_camera_does_not_see_says_nothing) {
    compare(3, 1.0, wall_at(kNone));
    compare(3, 0.5, wall_at(0.7F));                    // all of it behind what the camera sees
    compare(3, 1.2, wall_at(2.0F), {1.0, 0.0, -0.9});  // beside the picture
    compare(3, 1.2, wall_at(2.0F), {0.0, 0.0, -1.0});  // behind the camera
    EXPECT_EQ(findings(), 0U);
}

TEST_F(CrossCheckTest, in_front_of_the_robot_the_camera_sees_through_but_the_robot_is_no_surface) {
    const DepthImage robot = wall_at(2.0F);
    const DepthImage no_world = wall_at(kNone);
    for (int i = 0; i < 6; ++i) {
        give(cross_check_, beam(++number_, i < 3 ? 0.5 : i < 5 ? 1.0 : 1.4));
        show(cross_check_, robot, no_world, HostTime{100'000'000LL * number_});
    }
    EXPECT_EQ(evidence().in_free_space, 3U);
    EXPECT_EQ(findings(), 3U);
}

TEST_F(CrossCheckTest, one_pixel_of_the_inner_cone_that_may_hold_the_surface_is_enough_for_doubt) {
    // At 0.5 m the inner cone is 12 cm wide, 4 pixels of 3 cm: one of them sees something near.
    DepthImage image = wall_at(3.0F);
    for (int u = 0; u < 100; ++u) image.depth_m[static_cast<std::size_t>(51 * 100 + u)] = 1.5F;
    number_ = 14;  // the next beams are at y = 0
    compare(4, 0.5, image);
    EXPECT_EQ(findings(), 0U);
    compare(4, 0.5, wall_at(3.0F));
    EXPECT_EQ(evidence().in_free_space, 4U);
}

TEST_F(CrossCheckTest, a_ray_that_passes_behind_an_outline_is_not_stopped_by_it) {
    // Across the picture at 1.5 m, in front of a wall at 3 m, to behind a post at 1 m, where it goes unseen.
    DepthImage image = wall_at(3.0F);
    for (int v = 0; v < 100; ++v)
        for (int u = 60; u < 80; ++u) image.depth_m[static_cast<std::size_t>(v * 100 + u)] = 1.0F;
    for (int i = 0; i < 5; ++i) {
        Beam across = beam(++number_, 0.9, {1.0, 0.0, 0.0});
        across.p_map_sensor = {-0.3 + 0.02 * number_, 0.0, 1.5};
        give(cross_check_, across);
        show(cross_check_, image, image, across.captured);
    }
    EXPECT_EQ(findings(), 0U);
}

// A contradiction is worth log(0.3 / 0.02) = 2.708, and log(0.999 / 1e-6) = 13.81 flags; an agreement is
// worth log(0.7 / 0.98) = -0.336, and log(0.001) = -6.91 clears.
TEST_F(CrossCheckTest, contradictions_over_eight_seconds_flag_a_sensor_and_twenty_one_agreements_clear_it) {
    compare(80, 0.5, wall_at(2.0F));
    EXPECT_FALSE(evidence().is_far_off);
    compare(1, 0.5, wall_at(2.0F));
    EXPECT_TRUE(evidence().is_far_off);
    EXPECT_TRUE(evidence().contradicts());
    compare(20, 1.0, wall_at(2.0F));
    EXPECT_TRUE(evidence().is_far_off);
    compare(1, 1.0, wall_at(2.0F));
    EXPECT_FALSE(evidence().is_far_off);
}

TEST_F(CrossCheckTest, five_contradictions_are_not_enough_whatever_their_time) {
    for (int i = 0; i < 5; ++i) {
        number_ += 30;
        compare(1, 0.5, wall_at(2.0F));
    }
    EXPECT_FALSE(evidence().is_far_off);
    compare(1, 0.5, wall_at(2.0F));
    EXPECT_TRUE(evidence().is_far_off);
    EXPECT_THAT(describe(evidence()), HasSubstr("6 of its ranges end where the camera sees free space"));
}

TEST_F(CrossCheckTest, what_contradicts_at_one_place_only_is_not_the_sensor) {
    for (int i = 0; i < 200; ++i) {
        ++number_;
        // From about the place, so that it always ends there.
        Beam at_post = beam(17, 0.5);
        at_post.captured = HostTime{100'000'000LL * number_};
        at_post.p_map_sensor.x() += i % 2 == 0 ? 0.03 : -0.03;
        give(cross_check_, at_post);
        show(cross_check_, wall_at(2.0F), wall_at(2.0F), at_post.captured);
    }
    EXPECT_EQ(evidence().in_free_space, 200U);
    EXPECT_FALSE(evidence().is_far_off);
}

TEST_F(CrossCheckTest, one_contradiction_among_twenty_never_flags_a_sensor) {
    for (int i = 0; i < 200; ++i) {
        compare(1, 0.5, wall_at(2.0F));
        compare(19, 1.0, wall_at(2.0F));
        ASSERT_FALSE(evidence().contradicts()) << i;
    }
}

TEST_F(CrossCheckTest, a_sensor_that_stands_still_says_a_thing_once) {
    for (int i = 0; i < 50; ++i) {
        Beam still = beam(0, 0.5);
        still.captured = HostTime{100'000'000LL * i};
        give(cross_check_, still);
        show(cross_check_, wall_at(2.0F), wall_at(2.0F), still.captured);
    }
    EXPECT_EQ(findings(), 1U);
    // It turns by three degrees, and again.
    for (int i = 50; i < 52; ++i) {
        Beam turned =
            beam(0, 0.5,
                 Eigen::AngleAxisd(0.0524 * (i - 49), Eigen::Vector3d::UnitX()) * Eigen::Vector3d::UnitZ());
        turned.captured = HostTime{100'000'000LL * i};
        give(cross_check_, turned);
        show(cross_check_, wall_at(2.0F), wall_at(2.0F), turned.captured);
    }
    EXPECT_EQ(findings(), 3U);
}

TEST_F(CrossCheckTest, only_beams_of_about_the_images_time_are_compared_and_each_but_once) {
    give(cross_check_, beam(10, 0.5));
    show(cross_check_, wall_at(2.0F), wall_at(2.0F), HostTime{1'150'000'001});
    EXPECT_EQ(findings(), 0U);
    give(cross_check_, beam(11, 0.5));
    show(cross_check_, wall_at(2.0F), wall_at(2.0F), HostTime{1'250'000'000});
    show(cross_check_, wall_at(2.0F), wall_at(2.0F), HostTime{1'250'000'000});
    EXPECT_EQ(findings(), 1U);
    give(cross_check_, beam(12, 0.5));
    cross_check_.forget_beams();
    show(cross_check_, wall_at(2.0F), wall_at(2.0F), HostTime{1'200'000'000});
    EXPECT_EQ(findings(), 1U);
}

// 6 cm are less than what is_far_off asks for, and enough to be named: of 14, each comparison brings at the
// least 0.15 less than (0.06 - 0.02)^2 / (2 * 0.028^2). It takes three seconds, and ten a second are
// compared.
TEST_F(CrossCheckTest, names_ranges_that_are_six_centimetres_off_and_forgets_it_when_they_are_right) {
    for (const auto& [off_m, fault] :
         {std::pair{0.06, RangeFault::ranges_too_long}, std::pair{-0.06, RangeFault::ranges_too_short}}) {
        compare(10, 1.0, wall_at(2.0F));
        EXPECT_EQ(evidence().fault, std::nullopt);
        int needed = 0;
        while (!evidence().fault && needed < 80) {
            compare(1, 1.0 + off_m, wall_at(2.0F));
            ++needed;
        }
        EXPECT_GT(needed, 29);
        EXPECT_LT(needed, 80);
        EXPECT_EQ(evidence().fault, fault);
        EXPECT_TRUE(evidence().contradicts());
        EXPECT_FALSE(evidence().is_far_off);
        EXPECT_THAT(describe(evidence()), HasSubstr("some centimetres too"));
        compare(5, 1.0, wall_at(2.0F));
        EXPECT_TRUE(evidence().contradicts());
        compare(50, 1.0, wall_at(2.0F));
        EXPECT_FALSE(evidence().contradicts());
    }
    compare(200, 1.015, wall_at(2.0F));
    EXPECT_FALSE(evidence().contradicts()) << "what a rig may be off is no fault";
}

TEST_F(CrossCheckTest, refuses_a_sensor_that_contradicts_while_others_agree) {
    compare(81, 0.5, wall_at(2.0F));
    ASSERT_TRUE(evidence().contradicts());
    EXPECT_TRUE(cross_check_.is_to_be_refused(4, 1));
    EXPECT_FALSE(cross_check_.is_to_be_refused(4, 0));
}

// Of a camera that no other sensor has shown to be where the rig has it, a sensor's contradiction may be the
// camera's.
TEST_F(CrossCheckTest, names_no_sensor_before_others_have_shown_where_the_camera_is) {
    cross_check_ = CrossCheck(rig(), {});
    compare(200, 0.5, wall_at(2.0F));
    EXPECT_EQ(evidence().in_free_space, 200U);
    EXPECT_FALSE(evidence().contradicts());
    EXPECT_EQ(evidence().verdict(), CrossCheckFinding::cannot_tell);
    EXPECT_EQ(evidence().doubt, SensorDoubt::camera_not_known);
    EXPECT_FALSE(cross_check_.is_to_be_refused(4, 1));
    compare(200, 1.06, wall_at(2.0F));
    EXPECT_FALSE(evidence().contradicts());
    EXPECT_EQ(evidence().doubt, SensorDoubt::camera_not_known);
    EXPECT_FALSE(cross_check_.pose().fault());
}

// One wall at right angles shows no turn; an offset and short ranges have to be excluded.
TEST_F(CrossCheckTest, cannot_tell_of_a_sensor_until_no_fault_is_left_that_would_have_shown) {
    EXPECT_EQ(evidence().doubt, SensorDoubt::too_few_comparisons);
    EXPECT_TRUE(evidence().not_excluded.all());
    compare(10, 1.0, wall_at(2.0F));
    EXPECT_EQ(evidence().doubt, SensorDoubt::too_few_comparisons);
    compare(40, 1.0, wall_at(2.0F));
    EXPECT_EQ(evidence().verdict(), CrossCheckFinding::agrees);
    EXPECT_EQ(evidence().doubt, std::nullopt);
    EXPECT_FALSE(evidence().not_excluded[static_cast<std::size_t>(RangeFault::ranges_too_short)]);
    EXPECT_TRUE(evidence().not_excluded[static_cast<std::size_t>(RangeFault::turned)]);
    while (evidence().verdict() == CrossCheckFinding::agrees) compare(1, 1.06, wall_at(2.0F));
    EXPECT_EQ(evidence().verdict(), CrossCheckFinding::cannot_tell);
    EXPECT_EQ(evidence().doubt, SensorDoubt::ambiguous);
    compare(60, 1.06, wall_at(2.0F));
    EXPECT_EQ(evidence().verdict(), CrossCheckFinding::contradicts);
    EXPECT_EQ(evidence().doubt, std::nullopt);
}

// As long as nobody tells it to go on, a beam is only compared when another one comes.
TEST_F(CrossCheckTest, compares_one_beam_at_a_time) {
    SeenImages images = seen(wall_at(2.0F), wall_at(2.0F));
    give(cross_check_, beam(1, 0.5));
    cross_check_.on_depth(images, Eigen::Isometry3d::Identity(), HostTime{100'000'000});
    EXPECT_EQ(findings(), 0U);
    give(cross_check_, beam(2, 0.5));
    EXPECT_EQ(findings(), 1U);
    give(cross_check_, beam(3, 0.5));
    EXPECT_EQ(findings(), 1U);
}

TEST_F(CrossCheckTest, looks_through_the_lens) {
    // A lens that shows the ray (0.9, 0) at 0.9 - 0.2 * 0.729 = 0.754. What is there is seen at column 87,
    // and not at 95, where a pinhole would look and see the wall.
    HostRig bent = rig();
    bent.cameras.front().intrinsics.lens.k1 = -0.2;
    CrossCheck cross_check(bent, {});
    DepthImage image = wall_at(2.0F);
    for (int v = 0; v < 100; ++v)
        for (int u = 92; u < 100; ++u) image.depth_m[static_cast<std::size_t>(v * 100 + u)] = kNone;
    Beam aside = beam(1, 0.3);
    aside.p_map_sensor = {0.9 * 1.2, 0.0, 0.9};
    give(cross_check, aside);
    show(cross_check, image, image, aside.captured);
    EXPECT_EQ(cross_check.evidence(4, 1).in_free_space, 1U);
    give(cross_check_, aside);
    show(cross_check_, image, image, aside.captured);
    EXPECT_EQ(findings(), 0U);
}

}  // namespace
}  // namespace octoskin
