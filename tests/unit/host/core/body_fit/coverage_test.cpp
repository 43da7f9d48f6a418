#include "host/core/body_fit/coverage.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/host/core/body_fit/shapes.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

constexpr double kEdge_m = 0.001;

TEST(Coverage, holds_for_a_triangle_in_one_capsule_that_reaches_its_corners_and_not_for_a_smaller_one) {
    const SurfaceMesh mesh{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.5, 0.1, 0.0}}, {{0, 1, 2}}};
    const std::vector<PosedCapsule> capsules{{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.098}};
    EXPECT_FALSE(first_uncovered(mesh, capsules, 0.002 + 1e-9, kEdge_m));
    const auto piece = first_uncovered(mesh, capsules, 0.001, kEdge_m);
    ASSERT_TRUE(piece);
    for (const Vector3d& corner : *piece) EXPECT_GT(corner.y(), 0.099 - kEdge_m);
}

/// The corners of the triangle are covered, and so are nearly all of its points.
TEST(Coverage, finds_a_gap_of_a_millimetre_between_two_capsules) {
    const SurfaceMesh mesh{{{-1.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 0.01, 0.0}}, {{0, 1, 2}}};
    std::vector<PosedCapsule> capsules{{{-1.0, 0.0, 0.0}, {-0.1005, 0.0, 0.0}, 0.1},
                                       {{0.1005, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.1}};
    const auto piece = first_uncovered(mesh, capsules, 0.0, 0.0002);
    ASSERT_TRUE(piece);
    for (const Vector3d& corner : *piece) EXPECT_LT(std::abs(corner.x()), 0.002);
    capsules[0].p_b.x() += 0.004;
    EXPECT_FALSE(first_uncovered(mesh, capsules, 0.0, 0.0002));
}

TEST(Coverage, needs_pieces_of_a_triangle_that_no_single_capsule_contains) {
    const SurfaceMesh mesh{{{-0.5, 0.0, 0.0}, {0.5, 0.0, 0.0}, {0.0, 0.02, 0.0}}, {{0, 1, 2}}};
    const std::vector<PosedCapsule> capsules{{{-0.5, 0.0, 0.0}, {0.01, 0.0, 0.0}, 0.05},
                                             {{-0.01, 0.0, 0.0}, {0.5, 0.0, 0.0}, 0.05}};
    EXPECT_FALSE(first_uncovered(mesh, capsules, 0.0, kEdge_m));
}

TEST(Coverage, grows_capsules_until_it_holds_and_no_further) {
    const SurfaceMesh mesh = box_mesh({0.2, 0.1, 0.1});
    std::vector<PosedCapsule> capsules{{{-0.1, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.068},
                                       {{0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}, 0.068}};
    grow_to_cover(mesh, capsules, 0.002, kEdge_m);
    EXPECT_FALSE(first_uncovered(mesh, capsules, 0.002, kEdge_m));
    const double to_corner_m = std::hypot(0.05, 0.05);
    for (const PosedCapsule& capsule : capsules) EXPECT_NEAR(capsule.radius_m, to_corner_m - 0.002, 1e-6);
}

}  // namespace
}  // namespace octoskin
