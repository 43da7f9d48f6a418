// One error of the camera that explains what several sensors contradict.
#include "host/core/cross_check/camera_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "host/core/cross_check/cross_check.hpp"

namespace octoskin {
namespace {

constexpr std::size_t kSide = 200;
constexpr CameraIntrinsics kCamera{
    .width = kSide, .height = kSide, .fx = 100, .fy = 100, .cx = 100, .cy = 100};
const Eigen::Vector3d kAhead(0.0, 0.0, 1.0);

/// A corner of two walls, seen from the true camera: one across the view at 2 m, one along it at the right.
double true_depth_m(double x_slope) {
    return x_slope > 0.4 ? 0.8 / x_slope : 2.0;
}

class CornerScene : public testing::Test {
  protected:
    CornerScene() {
        seen_.depth_m.resize(kSide * kSide);
        for (std::size_t v = 0; v < kSide; ++v)
            for (std::size_t u = 0; u < kSide; ++u)
                seen_.depth_m[v * kSide + u] =
                    static_cast<float>(true_depth_m((static_cast<double>(u) + 0.5 - 100.0) / 100.0));
        seen_.width = seen_.height = kSide;
    }

    /// Ranges of `sensors` from the origin of the true camera, to places all over the scene, longer by
    /// `off_m`, with the camera where the rig has it.
    void look(std::size_t sensors, const Eigen::Isometry3d& T_map_given, double off_m = 0.0,
              int rounds = 40) {
        const CameraView view({seen_, seen_, certainty_}, kCamera, T_map_given, 10.0);
        for (int i = 0; i < rounds; ++i) {
            for (std::size_t sensor = 0; sensor < sensors; ++sensor) {
                const double x = -0.7 + 1.4 * std::fmod(0.618 * (i + 7.0 * static_cast<double>(sensor)), 1.0);
                const double y = -0.6 + 1.2 * std::fmod(0.414 * (i + 3.0 * static_cast<double>(sensor)), 1.0);
                const Eigen::Vector3d direction = Eigen::Vector3d(x, y, 1.0).normalized();
                const double range_m = true_depth_m(x) * Eigen::Vector3d(x, y, 1.0).norm() + off_m;
                const RayReach reach = view.reach(Eigen::Vector3d::Zero(), direction, 4.0);
                if (!reach.surface_m) continue;
                const Eigen::Vector3d p = view.T_camera_map() * (*reach.surface_m * direction);
                const auto plane = view.plane_at(p);
                if (!plane) continue;
                const PlaneHit hit{.p = p,
                                   .direction = view.T_camera_map().linear() * direction,
                                   .plane = *plane,
                                   .share = 1.0};
                if (const auto change = range_change(
                        {.off_m = range_m - *reach.surface_m, .sigma_m = 0.02, .is_from_behind = false},
                        {&hit, 1}))
                    judge_.compare(static_cast<std::uint16_t>(sensor), *change);
            }
            judge_.decide();
        }
    }

    static Eigen::Isometry3d turned(double deg, const Eigen::Vector3d& axis) {
        return Eigen::Isometry3d(Eigen::AngleAxisd(-deg * M_PI / 180.0, axis));
    }

    DepthImage seen_;
    std::vector<Certainty> certainty_ = std::vector<Certainty>(kSide * kSide, Certainty::clear);
    CameraJudge judge_{4};
};

TEST_F(CornerScene, a_camera_that_is_where_the_rig_has_it_is_not_named) {
    look(4, Eigen::Isometry3d::Identity());
    EXPECT_FALSE(judge_.error());
    EXPECT_FALSE(judge_.is_suspect());
    EXPECT_LT(judge_.may_misplace_m(0, 2.0 * kAhead), 0.12);  // two walls: nothing of its height
}

TEST_F(CornerScene, one_that_is_three_degrees_off_is_named_with_about_that) {
    look(4, turned(3.0, Eigen::Vector3d::UnitY()));
    ASSERT_TRUE(judge_.error());
    EXPECT_GE(judge_.evidence().explained, 3U);
    EXPECT_NEAR(judge_.error()->turn_deg.y(), 3.0, 1.1);
    EXPECT_LE(std::abs(judge_.error()->turn_deg.x()), 1.0);
    EXPECT_GT(judge_.may_misplace_m(0, 2.0 * kAhead), 0.08);
}

TEST_F(CornerScene, without_other_sensors_the_camera_may_be_anywhere_that_a_mount_may_be) {
    EXPECT_GT(judge_.may_misplace_m(0, 2.0 * kAhead), 0.25);
    // The sensor's own ranges say nothing of the camera by which it is judged.
    look(1, Eigen::Isometry3d::Identity());
    EXPECT_GT(judge_.may_misplace_m(0, 2.0 * kAhead), 0.25);
    EXPECT_LT(judge_.may_misplace_m(1, 2.0 * kAhead), 0.15);
}

TEST_F(CornerScene, one_whose_depth_is_five_percent_short_is_named_until_it_is_right) {
    for (float& depth_m : seen_.depth_m) depth_m /= 1.05F;
    look(4, Eigen::Isometry3d::Identity());
    EXPECT_TRUE(judge_.error());
    for (float& depth_m : seen_.depth_m) depth_m *= 1.05F;
    look(4, Eigen::Isometry3d::Identity(), 0.0, 2000);
    EXPECT_FALSE(judge_.error());
}

TEST_F(CornerScene, one_sensor_that_is_off_is_not_the_camera) {
    look(4, Eigen::Isometry3d::Identity());
    for (int i = 0; i < 40; ++i) look(1, Eigen::Isometry3d::Identity(), 0.06, 1);
    EXPECT_FALSE(judge_.error()) << judge_.evidence().evidence;
    EXPECT_LE(judge_.evidence().evidence, 1.0);
}

TEST_F(CornerScene, offsets_of_a_centimetre_that_each_sensor_has_are_not_the_camera) {
    look(4, Eigen::Isometry3d::Identity(), 0.01, 100);
    EXPECT_FALSE(judge_.error()) << judge_.evidence().evidence;
    EXPECT_FALSE(judge_.is_suspect());
}

TEST_F(CornerScene, the_error_is_described_with_its_turn_shift_and_scale) {
    const PoseFault fault{
        .camera = CameraError{.turn_deg = {0.0, 2.0, 0.0}, .shift_m = {0.03, 0.0, 0.0}, .depth_scale = 1.015},
        .joint = std::nullopt,
        .explained = 4};
    const std::string text = describe(fault, {});
    EXPECT_NE(text.find("turned by 2.0 deg, shifted by 3.0 cm, its depth off by 1.5 %"), std::string::npos)
        << text;
}

TEST_F(CornerScene, what_is_off_by_more_than_a_camera_is_says_nothing) {
    look(4, Eigen::Isometry3d::Identity(), 0.3);
    EXPECT_FALSE(judge_.error());
    EXPECT_EQ(judge_.evidence().evidence, 0.0);
}

}  // namespace
}  // namespace octoskin
