#include "host/core/body_fit/fit_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "host/core/body_fit/golden_turn.hpp"
#include "tests/unit/host/core/body_fit/shapes.hpp"

namespace octoskin {
namespace {

FitMeasures measures_of(const SurfaceMesh& mesh, const std::vector<PosedCapsule>& capsules) {
    const MeshDistance distance(mesh);
    const auto hull = ConvexHull::around(mesh.vertices);
    return measure(capsules, distance, hull ? &*hull : nullptr);
}

TEST(GoldenTurn, stays_with_the_cosine_and_sine_of_the_library) {
    GoldenTurn turn;
    for (int i = 0; i < 100'000; ++i, turn.advance()) {
        const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
        ASSERT_NEAR(turn.cosine(), std::cos(angle), 1e-9) << i;
        ASSERT_NEAR(turn.sine(), std::sin(angle), 1e-9) << i;
    }
}

TEST(FitMeasures, of_a_ball_around_a_cube_are_those_of_geometry) {
    const double radius_m = 0.1 * std::sqrt(3.0);
    const FitMeasures found = measures_of(box_mesh({0.2, 0.2, 0.2}), {{{0, 0, 0}, {0, 0, 0}, radius_m}});
    const double ball_m3 = 4.0 / 3.0 * std::numbers::pi * std::pow(radius_m, 3);
    EXPECT_NEAR(*found.excess_ratio, (ball_m3 - 0.008) / 0.008, 0.02);
    EXPECT_NEAR(found.protrusion_max_m, radius_m - 0.1, 2e-4);  // above the middle of a face
}

TEST(FitMeasures, count_a_place_that_two_capsules_take_once) {
    const PosedCapsule capsule{{0, 0, -0.2}, {0, 0, 0.2}, 0.1};
    const SurfaceMesh mesh = capsule_mesh(0.4, 0.05, 96, 24);
    const FitMeasures once = measures_of(mesh, {capsule});
    const FitMeasures twice = measures_of(mesh, {capsule, capsule});
    EXPECT_DOUBLE_EQ(*once.excess_ratio, *twice.excess_ratio);
    EXPECT_NEAR(once.protrusion_p95_m, 0.05, 1e-3);
    EXPECT_NEAR(once.protrusion_max_m, 0.05, 1e-3);
}

TEST(FitMeasures, are_zero_for_what_is_the_mesh) {
    const FitMeasures found =
        measures_of(capsule_mesh(0.3, 0.06, 200, 50), {{{0, 0, -0.15}, {0, 0, 0.15}, 0.06}});
    EXPECT_LT(*found.excess_ratio, 0.01);
    EXPECT_LT(found.protrusion_max_m, 3e-4);
}

/// Balls along the walls of a room: its inner surface is far from the mesh, but not outer surface.
TEST(FitMeasures, leave_out_a_hollow_that_the_set_encloses) {
    SurfaceMesh mesh = box_mesh({1.0, 1.0, 1.0});
    std::vector<PosedCapsule> capsules;
    for (double x = -0.4; x <= 0.41; x += 0.2) {
        for (double y = -0.4; y <= 0.41; y += 0.2) {
            for (const double z : {-0.44, 0.44}) {
                capsules.push_back({{x, y, z}, {x, y, z}, 0.16});
                capsules.push_back({{x, z, y}, {x, z, y}, 0.16});
                capsules.push_back({{z, x, y}, {z, x, y}, 0.16});
            }
        }
    }
    EXPECT_LT(measures_of(mesh, capsules).protrusion_max_m, 0.12);
}

TEST(FitMeasures, have_no_ratio_for_a_flat_mesh) {
    const SurfaceMesh mesh{{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}};
    EXPECT_FALSE(measures_of(mesh, {{{0, 0, 0}, {0.1, 0, 0}, 0.1}}).excess_ratio);
}

}  // namespace
}  // namespace octoskin
