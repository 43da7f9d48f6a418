#include "host/lab/report/view.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace octoskin::report {
namespace {

const Eigen::AlignedBox3d kBox{Eigen::Vector3d(-0.6, -1.2, -0.04), Eigen::Vector3d(1.4, 1.2, 1.1)};

/// Where a point comes to lie in a picture: -1..1 across and down. Oracle: projection by the pinhole model.
Eigen::Vector2d projected(const View& view, const Eigen::Vector3d& point) {
    const Eigen::Vector3d forward = (view.target - view.eye).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d down = forward.cross(right);
    const Eigen::Vector3d offset = point - view.eye;
    const double half_height = std::tan(view.vertical_fov_rad / 2.0);
    const double half_width = half_height * view.size.width / view.size.height;
    return {offset.dot(right) / offset.dot(forward) / half_width,
            offset.dot(down) / offset.dot(forward) / half_height};
}

TEST(Views, hold_every_corner_and_leave_little_room_around) {
    const auto corners = corners_of(kBox);
    const ViewPair views = views_of(corners);
    for (const View& view : {views.front, views.back}) {
        double widest = 0.0;
        for (const auto& corner : corners) {
            widest = std::max(widest, projected(view, corner).cwiseAbs().maxCoeff());
        }
        EXPECT_LT(widest, 1.0);
        EXPECT_GT(widest, 0.9);
    }
}

TEST(Views, look_from_the_robots_side_and_from_the_cameras_from_above) {
    const ViewPair views = views_of(corners_of(kBox));
    EXPECT_LT(views.front.eye.x(), kBox.min().x());
    EXPECT_GT(views.back.eye.x(), kBox.max().x());
    EXPECT_GT(views.front.eye.z(), kBox.max().z());
    EXPECT_GT(views.back.eye.z(), kBox.max().z());
}

TEST(Views, of_a_single_point_have_it_in_the_middle) {
    const std::vector<Eigen::Vector3d> point = {{0.5, 0.5, 0.5}};
    const View view = views_of(point).front;
    EXPECT_TRUE(shows(view, point.front()));
    EXPECT_LT((view.target - point.front()).norm(), 1e-9);
}

TEST(Views, show_what_lies_within_the_picture_and_before_the_eye) {
    const View view{.eye = {0, 0, 0}, .target = {1, 0, 0}, .vertical_fov_rad = 1.0, .size = {40, 20}};
    // Half the picture is tan(0.5) = 0.546 high and 1.093 wide at 1 m.
    EXPECT_TRUE(shows(view, {1.0, 0.0, 0.54}));
    EXPECT_FALSE(shows(view, {1.0, 0.0, 0.55}));
    EXPECT_TRUE(shows(view, {1.0, -1.09, 0.0}));
    EXPECT_FALSE(shows(view, {1.0, -1.10, 0.0}));
    EXPECT_FALSE(shows(view, {-1.0, 0.0, 0.0}));
}

TEST(ViewRays, run_through_the_middle_and_to_the_right_and_down) {
    const View view{.eye = {0, 0, 0}, .target = {1, 0, 0}, .vertical_fov_rad = 1.0, .size = {40, 20}};
    const ViewRays rays(view);
    EXPECT_TRUE(rays.direction(20.0, 10.0).isApprox(Eigen::Vector3f::UnitX(), 1e-6F));
    EXPECT_LT(rays.direction(39.0, 10.0).y(), 0.0F);
    EXPECT_LT(rays.direction(20.0, 19.0).z(), 0.0F);
    EXPECT_NEAR(rays.pixel_size(), 2.0 * std::tan(0.5) / 20.0, 1e-12);
    EXPECT_GT(rays.sun().z(), 0.5F);
    EXPECT_LT(rays.sun().x(), 0.0F) << "from behind the viewer";
}

}  // namespace
}  // namespace octoskin::report
