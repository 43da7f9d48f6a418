#include "host/lab/report/tracer.hpp"

#include <gtest/gtest.h>

#include <array>

#include "host/lab/report/ray_scene.hpp"

namespace octoskin::report {
namespace {

constexpr Colour kRed{0.5F, 0.0F, 0.0F};
constexpr Colour kGreen{0.0F, 0.5F, 0.0F};

/// Straight down on the square of 2 m round the origin from 4 m: 45 by 45 pixels.
View from_above() {
    return {.eye = {0, 0.001, 4}, .target = {0, 0, 0}, .vertical_fov_rad = 0.6, .size = {45, 45}};
}

/// A square of the plane z = `z`, facing up.
Face floor_face(float half, float z, Colour colour) {
    return {{Eigen::Vector3f(-half, -half, z), Eigen::Vector3f(half, -half, z),
             Eigen::Vector3f(half, half, z), Eigen::Vector3f(-half, half, z)},
            colour};
}

std::array<int, 4> pixel(const Image& image, std::uint32_t column, std::uint32_t row) {
    const std::uint8_t* at = &image.rgba[std::size_t{4} * (row * image.width + column)];
    return {at[0], at[1], at[2], at[3]};
}

TEST(RayScene, finds_the_first_of_several_shapes) {
    Geometry geometry;
    geometry.faces.push_back(floor_face(1.0F, 0.0F, kRed));
    geometry.bodies.push_back({{-1.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 1.0F}, 0.25F, kGreen});
    const RayScene scene(geometry);
    const auto body = scene.first_hit({0.0F, 0.0F, 3.0F}, -Eigen::Vector3f::UnitZ());
    ASSERT_TRUE(body);
    EXPECT_EQ(body->shape, Shape::body);
    EXPECT_NEAR(body->range_m, 1.75F, 1e-4F);
    EXPECT_GT(body->normal.z(), 0.99F);
    const auto face = scene.first_hit({0.5F, -0.5F, 3.0F}, -Eigen::Vector3f::UnitZ());
    ASSERT_TRUE(face);
    EXPECT_EQ(face->shape, Shape::face);
    EXPECT_NEAR(face->u, 0.75F, 1e-5F);
    EXPECT_NEAR(face->v, 0.25F, 1e-5F);
    EXPECT_FALSE(scene.first_hit({5.0F, 5.0F, 3.0F}, -Eigen::Vector3f::UnitZ()));
}

TEST(RayScene, lets_light_through_lines_but_not_through_bodies) {
    Geometry geometry;
    geometry.lines.push_back({{-1.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 1.0F}, 0.1F, kGreen});
    EXPECT_FALSE(RayScene(geometry).obstacle({0, 0, 0}, Eigen::Vector3f::UnitZ(), 10.0F));
    EXPECT_TRUE(RayScene(geometry).first_hit({0, 0, 0}, Eigen::Vector3f::UnitZ()));
    geometry.bodies = geometry.lines;
    const auto obstacle = RayScene(geometry).obstacle({0, 0, 0}, Eigen::Vector3f::UnitZ(), 10.0F);
    ASSERT_TRUE(obstacle);
    EXPECT_NEAR(*obstacle, 0.9F, 1e-4F);
    EXPECT_FALSE(RayScene(geometry).obstacle({0, 0, 0}, Eigen::Vector3f::UnitZ(), 0.5F));
}

TEST(RayScene, of_nothing_hits_nothing) {
    const RayScene scene(Geometry{});
    EXPECT_FALSE(scene.first_hit({0, 0, 0}, Eigen::Vector3f::UnitZ()));
    EXPECT_FALSE(scene.obstacle({0, 0, 0}, Eigen::Vector3f::UnitZ(), 10.0F));
}

TEST(Tracer, paints_what_is_there_and_leaves_the_rest_transparent) {
    Geometry geometry;
    geometry.faces.push_back(floor_face(0.5F, 0.0F, kRed));
    const Image image = Tracer(geometry).render(from_above());
    ASSERT_EQ(image.rgba.size(), 45U * 45U * 4U);
    const auto middle = pixel(image, 20, 24);
    EXPECT_GT(middle[0], 150);
    EXPECT_EQ(middle[1], 0);
    EXPECT_EQ(middle[3], 255);
    EXPECT_EQ(pixel(image, 1, 1), (std::array<int, 4>{0, 0, 0, 0}));
}

TEST(Tracer, draws_edges_of_faces_darker) {
    Geometry geometry;
    geometry.faces.push_back(floor_face(1.0F, 0.0F, kRed));
    View close = from_above();
    close.vertical_fov_rad = 0.49;  // the face's edge is just in the picture
    const Image image = Tracer(geometry).render(close);
    EXPECT_LT(pixel(image, 0, 22)[0] + 20, pixel(image, 10, 22)[0]);
}

TEST(Tracer, casts_a_shadow_of_bodies_and_none_of_lines) {
    Geometry geometry;
    geometry.triangles.push_back(
        {{Eigen::Vector3f(-5, -5, 0), Eigen::Vector3f(5, -5, 0), Eigen::Vector3f(0, 9, 0)}, kRed});
    const auto darkest = [](const Image& image) {
        int red = 255;
        for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
            red = image.rgba[i + 1] == 0 ? std::min<int>(red, image.rgba[i]) : red;
        }
        return red;
    };
    const int plain = darkest(Tracer(geometry).render(from_above()));
    const Rod rod{{-1.0F, 0.0F, 0.8F}, {1.0F, 0.0F, 0.8F}, 0.2F, kGreen};
    geometry.lines = {rod};
    EXPECT_EQ(darkest(Tracer(geometry).render(from_above())), plain);
    geometry.lines.clear();
    geometry.bodies = {rod};
    EXPECT_LT(darkest(Tracer(geometry).render(from_above())), plain - 30);
}

TEST(Tracer, darkens_the_corner_of_two_walls) {
    Geometry geometry;
    geometry.faces.push_back(floor_face(0.5F, 0.0F, kRed));
    const Image open = Tracer(geometry).render(from_above());
    // The picture's right is -x, and the sun comes from its left: the wall takes away light of the sky only.
    geometry.faces.push_back({{Eigen::Vector3f(-0.5F, -0.5F, 0.0F), Eigen::Vector3f(-0.5F, 0.5F, 0.0F),
                               Eigen::Vector3f(-0.5F, 0.5F, 1.0F), Eigen::Vector3f(-0.5F, -0.5F, 1.0F)},
                              kGreen});
    const Image walled = Tracer(geometry).render(from_above());
    const auto red_beside_wall = [](const Image& image) { return pixel(image, 29, 22)[0]; };
    EXPECT_LT(red_beside_wall(walled), red_beside_wall(open) - 4);
}

TEST(Tracer, draws_triangles_on_the_stage_only) {
    Geometry geometry;
    geometry.triangles.push_back(
        {{Eigen::Vector3f(-9, -9, 0), Eigen::Vector3f(9, -9, 0), Eigen::Vector3f(0, 9, 0)}, kRed});
    geometry.stage =
        Eigen::AlignedBox3f(Eigen::Vector3f(-0.5F, -0.5F, -1.0F), Eigen::Vector3f(0.5F, 0.5F, 1.0F));
    const Image image = Tracer(geometry).render(from_above());
    EXPECT_EQ(pixel(image, 22, 22)[3], 255);
    EXPECT_EQ(pixel(image, 2, 22)[3], 0);
}

TEST(Tracer, gives_the_same_bytes_every_time) {
    Geometry geometry;
    geometry.faces.push_back(floor_face(0.5F, 0.0F, kRed));
    geometry.bodies.push_back({{-1.0F, 0.0F, 0.6F}, {1.0F, 0.2F, 0.6F}, 0.1F, kGreen});
    const Image first = Tracer(geometry).render(from_above());
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(Tracer(geometry).render(from_above()).rgba, first.rgba);
    }
}

}  // namespace
}  // namespace octoskin::report
