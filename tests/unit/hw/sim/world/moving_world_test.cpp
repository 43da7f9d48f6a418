#include "hw/sim/world/moving_world.hpp"

#include <gtest/gtest.h>

#include "hw/sim/world/shapes.hpp"

namespace octoskin::sim {
namespace {

Solid cube(const std::string& model, const Eigen::Vector3d& centre) {
    TriangleMesh mesh = box_mesh({0.2, 0.2, 0.2});
    for (Eigen::Vector3d& vertex : mesh.vertices) vertex += centre;
    return {model + "/body/cube", model, mesh.vertices, mesh.triangles, true};
}

/// From the origin along x: the range of what stands there.
double seen_m(const World& world) {
    const auto hit = world.cast({0, 0, 0}, {1, 0, 0}, 100.0);
    return hit ? hit->range_m : 0.0;
}

ModelPlace at(double from_s, bool is_there = true, const Eigen::Vector3d& offset_m = {0, 0, 0},
              bool moves_on = false) {
    return {from_s, is_there, offset_m, moves_on};
}

TEST(MovingWorld, has_what_comes_and_has_not_what_has_left) {
    MovingWorld world({cube("wall", {5, 0, 0}), cube("ball", {2, 0, 0})},
                      {{"ball", {at(-1, false), at(1), at(3, false)}}});
    EXPECT_NEAR(seen_m(world.at(-2.0)), 1.9, 1e-6) << "before the first place, where the SDF has it";
    EXPECT_NEAR(seen_m(world.at(0.999)), 4.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(1.0)), 1.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(2.999)), 1.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(3.0)), 4.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(1.5)), 1.9, 1e-6) << "and back";
}

TEST(MovingWorld, moves_at_one_speed_from_place_to_place) {
    MovingWorld world({cube("ball", {2, 0, 0})},
                      {{"ball", {at(0), at(1, true, {1, 0, 0}, true), at(3, true, {3, 0, 0})}}});
    EXPECT_NEAR(seen_m(world.at(0.5)), 1.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(1.0)), 2.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(2.0)), 3.9, 1e-6);
    EXPECT_NEAR(seen_m(world.at(2.005)), 3.9, 1e-6) << "in steps of 10 ms";
    EXPECT_NEAR(seen_m(world.at(2.01)), 3.91, 1e-6);
    EXPECT_NEAR(seen_m(world.at(10.0)), 4.9, 1e-6);
}

TEST(MovingWorld, is_made_anew_only_when_something_moved) {
    MovingWorld world({cube("ball", {2, 0, 0})}, {{"ball", {at(1, false), at(2)}}});
    const World* before = &world.at(0.0);
    EXPECT_EQ(&world.at(0.9), before);
    EXPECT_EQ(world.at(1.5).solids().size(), 0U);
}

}  // namespace
}  // namespace octoskin::sim
