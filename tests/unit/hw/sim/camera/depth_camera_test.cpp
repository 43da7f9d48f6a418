// The depth camera. Oracles: the depth of planes and boxes worked out by hand; one ray at a time for the
// robot; the moments of the normal distribution for the noise.
#include "hw/sim/camera/depth_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/wire/crc.hpp"
#include "hw/sim/world/shapes.hpp"
#include "tests/support/lens/published_lens.hpp"

namespace octoskin::sim {
namespace {

Solid box_at(const Eigen::Vector3d& size_m, const Eigen::Vector3d& centre) {
    const auto mesh = transformed(box_mesh(size_m), Eigen::Isometry3d(Eigen::Translation3d(centre)));
    return {"box/body/box", "box", mesh.vertices, mesh.triangles, true};
}

/// Looks along +x of base from `p_base_camera`: picture right = -y, picture down = -z.
rig::Camera camera_at(const Eigen::Vector3d& p_base_camera) {
    rig::Camera camera{
        .width = 512, .height = 424, .fx = 365, .fy = 365, .cx = 256, .cy = 212, .rate_hz = 10};
    camera.depth_min_m = 0.5;
    camera.depth_max_m = 4.5;
    camera.T_link_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    camera.T_link_camera.translation() = p_base_camera;
    return camera;
}

/// A wall whose face is 2 m ahead, over the whole picture.
World wall() {
    return World(std::vector<Solid>{box_at({0.2, 20, 20}, {2.1, 0, 0})});
}

std::uint16_t at(const std::vector<std::uint16_t>& image, std::size_t u, std::size_t v) {
    return image[v * 512 + u];
}

TEST(DepthCamera, measures_depth_along_the_optical_axis_not_along_the_ray) {
    const World world = wall();
    const DepthCamera camera(world, camera_at({0, 0, 0}), {}, 0);
    for (const std::uint16_t depth_mm : camera.render({}, 0)) {
        ASSERT_EQ(depth_mm, 2000);
    }
}

TEST(DepthCamera, sees_a_mesh_of_a_link_as_the_same_solid_of_the_world) {
    const Eigen::Isometry3d T_base_link =
        Eigen::Translation3d(1.2, 0.1, -0.2) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    const TriangleMesh mesh = box_mesh({0.2, 0.3, 0.4});
    const TriangleMesh posed = transformed(mesh, T_base_link);
    const World with_box(std::vector<Solid>{box_at({0.2, 20, 20}, {2.1, 0, 0}),
                                            {"b/b/b", "b", posed.vertices, posed.triangles, true}});
    const World without = wall();
    const Body body({}, {{"link", mesh}, {"ignored", mesh}});
    const auto posed_body = body.at({{"link", T_base_link}, {"ignored", T_base_link}}, {"ignored"});
    ASSERT_EQ(posed_body.meshes.size(), 1U);
    const auto expected = DepthCamera(with_box, camera_at({0, 0, 0}), {}, 0).render({}, 0);
    const auto found = DepthCamera(without, camera_at({0, 0, 0}), {}, 0).render(posed_body, 0);
    std::size_t on_box = 0, other = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        on_box += expected[i] < 1990 ? 1U : 0U;
        other += std::abs(found[i] - expected[i]) > 1 ? 1U : 0U;
    }
    EXPECT_GT(on_box, 5000U);
    EXPECT_LE(other, 5U);  // single precision at the outline
}

TEST(DepthCamera, sends_its_rays_through_the_middles_of_the_pixels) {
    // A box of 1 m x 1 m x 0.6 m (depth x width x height) whose front is 1 m ahead, shifted so that it covers
    // y in (-0.2, 0.8) and z in (-0.5, 0.1). At depth 1 a pixel (u, v) looks at y = -(u + 0.5 - 256) / 365
    // and z = -(v + 0.5 - 212) / 365, so the box covers u + 0.5 in (256 - 292, 256 + 73) and v + 0.5 in
    // (175.5, 394.5).
    const World world(std::vector<Solid>{box_at({1.0, 1.0, 0.6}, {1.5, 0.3, -0.2})});
    const DepthCamera camera(world, camera_at({0, 0, 0}), {}, 0);
    const auto image = camera.render({}, 0);
    EXPECT_EQ(at(image, 0, 300), 1000);
    EXPECT_EQ(at(image, 328, 300), 1000);
    EXPECT_EQ(at(image, 330, 300), 0);
    EXPECT_EQ(at(image, 100, 176), 1000);
    EXPECT_EQ(at(image, 100, 174), 0);
    EXPECT_EQ(at(image, 100, 393), 1000);
    EXPECT_EQ(at(image, 100, 395), 0);
}

// Oracle: OpenCV's published formula and its inverse.
TEST(DepthCamera, bends_its_picture_as_the_lens_does) {
    rig::Camera model = camera_at({0, 0, 0});
    model.lens = {.k1 = 0.2624, .k2 = -0.9531, .p1 = -0.0054, .p2 = 0.0026, .k3 = 1.1633};
    const testing_support::PublishedCamera published{
        "", 365, 365, 255.5, 211.5, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}};
    // The box of the test above: its right edge is 0.2 to the right of the axis, 1 m ahead.
    const World world(std::vector<Solid>{box_at({1.0, 1.0, 0.6}, {1.5, 0.3, -0.2})});
    const DepthCamera camera(world, model, {}, 0);
    const auto image = camera.render({}, 0);
    for (double down = -0.08; down < 0.45; down += 0.01) {
        const auto [column, row] = testing_support::project(published, 0.2, down);
        const auto u = static_cast<std::size_t>(std::lround(column));
        const auto v = static_cast<std::size_t>(std::lround(row));
        EXPECT_EQ(at(image, u - 1, v), 1000) << down;
        EXPECT_EQ(at(image, u + 1, v), 0) << down;
    }
    // A robot in front of the wall, pixel by pixel.
    const World behind = wall();
    const std::vector<BodyCapsule> body{{{1.0, 0.4, -0.3}, {1.4, 0.7, 0.5}, 0.08}};
    const auto picture = DepthCamera(behind, model, {}, 0).render(body, 0);
    int robot_pixels = 0;
    for (std::uint32_t v = 0; v < 424; v += 3) {
        for (std::uint32_t u = 0; u < 512; u += 3) {
            const auto [x, y] = testing_support::unproject(published, u, v);
            const auto t = cast_body(body, Eigen::Vector3d::Zero(), Eigen::Vector3d(1.0, -x, -y));
            const double depth_m = std::min(2.0, t.value_or(2.0));
            ASSERT_EQ(at(picture, u, v), std::lround(1e3 * depth_m)) << u << ", " << v;
            robot_pixels += depth_m < 2.0 ? 1 : 0;
        }
    }
    EXPECT_GT(robot_pixels, 500);
}

TEST(DepthCamera, sees_nothing_nearer_or_further_than_its_limits) {
    for (const double x : {0.501, 4.499}) {
        const World world(std::vector<Solid>{box_at({0.2, 20, 20}, {x + 0.1, 0, 0})});
        EXPECT_EQ(at(DepthCamera(world, camera_at({0, 0, 0}), {}, 0).render({}, 0), 10, 20),
                  std::lround(1e3 * x));
    }
    for (const double x : {0.499, 4.501}) {
        const World world(std::vector<Solid>{box_at({0.2, 20, 20}, {x + 0.1, 0, 0})});
        EXPECT_EQ(at(DepthCamera(world, camera_at({0, 0, 0}), {}, 0).render({}, 0), 10, 20), 0);
    }
}

TEST(DepthCamera, draws_the_robot_exactly_where_each_pixels_ray_meets_it) {
    const World world = wall();
    const rig::Camera model = camera_at({0, 0, 0});
    const DepthCamera camera(world, model, {}, 0);
    // In front; partly outside the picture; beside the camera and reaching into the picture; behind the wall;
    // behind the camera.
    const std::vector<std::vector<BodyCapsule>> bodies = {
        {{{1.0, -0.2, -0.1}, {1.4, 0.3, 0.2}, 0.08}},
        {{{1.0, 0.6, 0.0}, {1.2, 1.5, 0.8}, 0.1}},
        {{{-0.5, 0.3, 0.0}, {1.5, 0.1, 0.0}, 0.05}},
        {{{2.5, 0.0, 0.0}, {3.0, 0.0, 0.0}, 0.1}},
        {{{-1.0, 0.0, 0.0}, {-2.0, 0.5, 0.0}, 0.1}},
        {{{0.9, 0.1, 0.1}, {0.9, 0.1, 0.1}, 0.2}, {{0.8, 0.1, 0.1}, {0.8, -0.3, 0.1}, 0.05}}};
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto image = camera.render(bodies[i], 0);
        int robot_pixels = 0;
        for (std::uint32_t v = 0; v < 424; ++v) {
            for (std::uint32_t u = 0; u < 512; ++u) {
                const Eigen::Vector3d ray(1.0, -(u + 0.5 - 256) / 365, -(v + 0.5 - 212) / 365);
                const auto t = cast_body(bodies[i], Eigen::Vector3d::Zero(), ray);
                const double depth_m = std::min(2.0, t.value_or(2.0));
                const std::uint16_t expected =
                    depth_m < 0.5 ? std::uint16_t{0} : static_cast<std::uint16_t>(std::lround(1e3 * depth_m));
                ASSERT_EQ(at(image, u, v), expected) << "body " << i << " at " << u << ", " << v;
                robot_pixels += depth_m < 2.0 ? 1 : 0;
            }
        }
        EXPECT_EQ(robot_pixels > 1000, i != 3 && i != 4) << "body " << i;
    }
}

TEST(DepthCamera, has_gaussian_noise_of_the_given_deviation_in_every_pixel) {
    const World world = wall();
    const DepthCamera camera(world, camera_at({0, 0, 0}), gaussian_noise(0.03), 11);
    double sum = 0.0, squares = 0.0;
    const auto image = camera.render({}, 4);
    for (const std::uint16_t depth_mm : image) {
        ASSERT_NE(depth_mm, 0);
        sum += depth_mm - 2000.0;
        squares += (depth_mm - 2000.0) * (depth_mm - 2000.0);
    }
    const double n = static_cast<double>(image.size());
    EXPECT_NEAR(sum / n, 0.0, 0.33);                  // five standard errors
    EXPECT_NEAR(std::sqrt(squares / n), 30.0, 0.25);  // and the rounding's 0.29 mm
}

TEST(DepthCamera, has_noise_that_depends_on_seed_frame_and_pixel_alone) {
    const World world = wall();
    const DepthCamera camera(world, camera_at({0, 0, 0}), gaussian_noise(0.03), 11);
    const auto first = camera.render({}, 4);
    const auto other_frame = camera.render({}, 5);
    EXPECT_EQ(camera.render({}, 4), first) << "the order of rendering has a part in it";
    EXPECT_NE(other_frame, first);
    EXPECT_NE(DepthCamera(world, camera_at({0, 0, 0}), gaussian_noise(0.03), 12).render({}, 4), first);
    // A body in some pixels leaves the noise of all others.
    const auto with_body =
        camera.render(std::vector<BodyCapsule>{{{1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.1}}, 4);
    EXPECT_EQ(at(with_body, 5, 5), at(first, 5, 5));
    EXPECT_NE(at(with_body, 256, 212), at(first, 256, 212));
}

// The checksum is that of the image before the noise had models: recordings of a seed stay the same.
TEST(DepthCamera, gives_the_same_bytes_for_a_seed_as_in_earlier_versions) {
    const World world = wall();
    const DepthCamera camera(world, camera_at({0, 0, 0}), gaussian_noise(0.03), 11);
    std::vector<std::uint8_t> bytes;
    const std::vector<BodyCapsule> body{{{1.0, -0.2, -0.1}, {1.4, 0.3, 0.2}, 0.08}};
    for (const std::uint16_t depth_mm : camera.render(body, 4)) {
        bytes.push_back(static_cast<std::uint8_t>(depth_mm & 0xFF));
        bytes.push_back(static_cast<std::uint8_t>(depth_mm >> 8));
    }
    EXPECT_EQ(crc32(bytes), 0x9798006Du);
}

TEST(DepthCamera, measures_world_and_robot_with_the_noise_of_a_kinect) {
    const World world = wall();
    KinectNoise kinect;
    kinect.flying_share = 0.0;
    kinect.missing_share = 1.0;
    const DepthCamera camera(world, camera_at({0, 0, 0}), {kinect}, 11);
    const auto empty = camera.render({}, 4);
    EXPECT_EQ(std::ranges::count(empty, 0), 0);
    for (const std::uint16_t depth_mm : empty) ASSERT_NEAR(depth_mm, 2000, 60);
    // The outline of a robot in front of the wall is an edge.
    const auto robot = camera.render(std::vector<BodyCapsule>{{{1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.1}}, 4);
    EXPECT_NEAR(at(robot, 256, 212), 900, 15);
    EXPECT_GT(std::ranges::count(robot, 0), 200);
    EXPECT_EQ(at(robot, 5, 5), at(empty, 5, 5));
    // A wall beyond the limit, which noise of 33 mm brings back: P(noise < -10 mm) is 0.38.
    const World far(std::vector<Solid>{box_at({0.2, 20, 20}, {4.61, 0, 0})});
    const auto image = DepthCamera(far, camera_at({0, 0, 0}), {KinectNoise{}}, 0).render({}, 0);
    EXPECT_GT(std::ranges::count_if(image, [](auto depth_mm) { return depth_mm != 0; }), 60'000);
}

TEST(DepthCamera, noise_can_carry_a_surface_over_either_limit) {
    const World world(std::vector<Solid>{box_at({0.2, 20, 20}, {4.61, 0, 0})});  // its face at 4.51 m
    int seen = 0;
    for (const std::uint16_t depth_mm :
         DepthCamera(world, camera_at({0, 0, 0}), gaussian_noise(0.03), 0).render({}, 0)) {
        EXPECT_LE(depth_mm, 4500);
        seen += depth_mm != 0 ? 1 : 0;
    }
    // P(noise < -10 mm) at 30 mm is 0.36944.
    EXPECT_NEAR(seen / (512.0 * 424.0), 0.36944, 0.0052);
}

}  // namespace
}  // namespace octoskin::sim
