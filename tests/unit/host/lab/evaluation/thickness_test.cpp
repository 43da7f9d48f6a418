#include "host/lab/evaluation/thickness.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "hw/sim/world/shapes.hpp"

namespace octoskin::evaluation {
namespace {

using Extents = std::array<double, 3>;
using enum ThicknessClass;

/// Turned so that no face is parallel to an axis, and moved.
sim::Solid turned(const TriangleMesh& mesh) {
    Eigen::Isometry3d T_world_mesh = Eigen::Isometry3d::Identity();
    T_world_mesh.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
    T_world_mesh.pretranslate(Eigen::Vector3d(1.0, -2.0, 0.5));
    const auto placed = sim::transformed(mesh, T_world_mesh);
    return {"solid", "solid", placed.vertices, placed.triangles, true};
}

void expect_extents(const TriangleMesh& mesh, const Extents& expected) {
    const Extents extents = extents_of(turned(mesh));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(extents[i], expected[i], 1.2e-3 * expected[i]) << i;
}

TEST(Extents, are_the_edges_of_a_box_however_it_is_turned) {
    expect_extents(sim::box_mesh({0.5, 0.02, 0.3}), {0.02, 0.3, 0.5});
    expect_extents(sim::box_mesh({0.03, 0.03, 1.0}), {0.03, 0.03, 1.0});
    expect_extents(sim::box_mesh({0.2, 0.2, 0.2}), {0.2, 0.2, 0.2});
}

TEST(Extents, of_round_shapes_are_their_diameters_and_lengths) {
    expect_extents(sim::cylinder_mesh(0.003, 1.0), {0.006, 0.006, 1.0});
    expect_extents(sim::cylinder_mesh(0.2, 0.01), {0.01, 0.4, 0.4});
    expect_extents(sim::capsule_mesh(0.008, 0.3), {0.016, 0.016, 0.316});
    expect_extents(sim::ellipsoid_mesh({0.02, 0.02, 0.02}), {0.04, 0.04, 0.04});
}

TEST(Extents, of_nothing_are_zero) {
    EXPECT_EQ(extents_of({}), (Extents{0.0, 0.0, 0.0}));
}

TEST(Extents, of_a_large_mesh_take_no_long_time) {
    // 400,000 triangles on 4,600 vertices: it would take a minute if each normal were tried on each vertex.
    sim::Solid ball = turned(sim::ellipsoid_mesh({0.3, 0.2, 0.1}));
    const auto triangles = ball.triangles;
    for (int i = 0; i < 40; ++i)
        ball.triangles.insert(ball.triangles.end(), triangles.begin(), triangles.end());
    const Extents extents = extents_of(ball);
    EXPECT_NEAR(extents[0], 0.2, 0.01);
}

TEST(ThicknessClass, of_rods_has_no_gaps) {
    const auto rod = [](double thickness_m) { return thickness_class({thickness_m, thickness_m, 1.0}); };
    EXPECT_EQ(rod(0.005), rod_5_8_mm);
    EXPECT_EQ(rod(0.008), rod_5_8_mm);
    EXPECT_EQ(rod(0.00899), rod_5_8_mm);
    EXPECT_EQ(rod(0.009), rod_10_16_mm);
    EXPECT_EQ(rod(0.016), rod_10_16_mm);
    EXPECT_EQ(rod(0.018), rod_20_40_mm);
    EXPECT_EQ(rod(0.04), rod_20_40_mm);
    EXPECT_EQ(rod(0.05), rod_70_90_mm);
    EXPECT_EQ(rod(0.09), rod_70_90_mm);
    EXPECT_EQ(rod(0.1), other);
}

TEST(ThicknessClass, of_boards_and_other_solids) {
    EXPECT_EQ(thickness_class({0.003, 0.5, 1.0}), board);
    EXPECT_EQ(thickness_class({0.04, 0.1, 1.0}), board);
    EXPECT_EQ(thickness_class({0.01, 0.05, 1.0}), board) << "a slat";
    EXPECT_EQ(thickness_class({0.03, 0.06, 1.0}), rod_20_40_mm) << "a post";
    EXPECT_EQ(thickness_class({0.041, 0.2, 1.0}), other);
    EXPECT_EQ(thickness_class({0.3, 0.3, 0.3}), other);
    EXPECT_EQ(thickness_class({0.08, 0.08, 0.08}), rod_70_90_mm) << "a small ball";
    EXPECT_EQ(thickness_class({0.08, 0.1, 0.12}), other) << "neither long nor small";
    EXPECT_EQ(thickness_class({0.0, 3.0, 3.0}), other) << "a plane";
}

TEST(Thickness, of_a_plane_hides_all_behind_it) {
    const Thickness plane = thickness_of(turned(sim::plane_mesh(Eigen::Vector3d::UnitZ(), {3.0, 2.0})));
    EXPECT_EQ(plane.of_class, other);
    EXPECT_TRUE(std::isinf(plane.thickness_m));
    const Thickness cable = thickness_of(turned(sim::cylinder_mesh(0.004, 2.0)));
    EXPECT_EQ(cable.of_class, rod_5_8_mm);
    EXPECT_NEAR(cable.thickness_m, 0.008, 1e-5);
}

TEST(ThicknessClass, has_one_name_each) {
    std::vector<std::string_view> names;
    for (const auto thickness : kEveryThickness) names.push_back(name_of(thickness));
    EXPECT_EQ(names, (std::vector<std::string_view>{"rod_5_8_mm", "rod_10_16_mm", "rod_20_40_mm",
                                                    "rod_70_90_mm", "board", "other"}));
    for (std::size_t i = 0; i < kThicknessClasses; ++i)
        EXPECT_EQ(static_cast<std::size_t>(kEveryThickness[i]), i);
}

}  // namespace
}  // namespace octoskin::evaluation
