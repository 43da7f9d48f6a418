#include "host/core/body_fit/fit_capsules.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/core/body_fit/coverage.hpp"
#include "host/core/body_fit/fit_work.hpp"
#include "tests/unit/host/core/body_fit/shapes.hpp"

namespace octoskin {
namespace {

using Eigen::Vector3d;

constexpr double kFitEdge_m = 0.001;

/// Independent of the proof: no random point of the surface is farther out than that.
double farthest_outside_m(const SurfaceMesh& mesh, const std::vector<PosedCapsule>& capsules) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> uniform;
    double farthest_m = -1e9;
    for (int run = 0; run < 20'000; ++run) {
        const auto [a, b, c] = mesh.corners(random() % mesh.triangles.size());
        double u = uniform(random);
        double v = uniform(random);
        if (u + v > 1.0) {
            u = 1.0 - u;
            v = 1.0 - v;
        }
        double nearest_m = 1e9;
        for (const PosedCapsule& capsule : capsules)
            nearest_m = std::min(nearest_m, distance_to_surface(capsule, a + u * (b - a) + v * (c - a)));
        farthest_m = std::max(farthest_m, nearest_m);
    }
    return farthest_m;
}

TEST(FitCapsules, makes_one_capsule_of_a_capsule) {
    const BodyFit fit = fit_capsules(capsule_mesh(0.3, 0.06)).value();
    ASSERT_EQ(fit.capsules.size(), 1U);
    EXPECT_NEAR(fit.capsules[0].radius_m, 0.06, 0.003);
    EXPECT_LT(*fit.measures.excess_ratio, 0.06);
    EXPECT_LT(fit.measures.protrusion_max_m, 0.004);
}

TEST(FitCapsules, covers_each_shape_and_keeps_its_limits) {
    const std::vector<SurfaceMesh> meshes{box_mesh({0.3, 0.1, 0.05}), angle_mesh()};
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const BodyFit fit = fit_capsules(meshes[i]).value();
        EXPECT_FALSE(first_uncovered(meshes[i], fit.capsules, kCoveredWithin_m, kFitEdge_m)) << "shape " << i;
        EXPECT_LE(farthest_outside_m(meshes[i], fit.capsules), kCoveredWithin_m) << "shape " << i;
        EXPECT_LE(fit.capsules.size(), kCapsulesMost) << "shape " << i;
        EXPECT_LE(fit.measures.protrusion_p99_m, 0.030) << "shape " << i;
        EXPECT_LE(fit.measures.protrusion_max_m, 0.050) << "shape " << i;
    }
}

TEST(FitCapsules, needs_little_of_its_work_for_a_link_and_gives_up_large_triangles_that_cross) {
    EXPECT_LT(fit_capsules(angle_mesh()).value().work, FitWork::kMost / 4);
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-2.8, 2.8);
    SurfaceMesh mesh;
    for (int i = 0; i < 60'000; ++i)
        mesh.vertices.emplace_back(uniform(random), uniform(random), uniform(random));
    for (int i = 0; i < 60'000; i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
    EXPECT_FALSE(fit_capsules(mesh));
}

TEST(FitCapsules, gives_the_same_numbers_each_time) {
    const SurfaceMesh mesh = angle_mesh();
    const BodyFit first = fit_capsules(mesh).value();
    const BodyFit second = fit_capsules(mesh).value();
    ASSERT_EQ(first.capsules.size(), second.capsules.size());
    for (std::size_t i = 0; i < first.capsules.size(); ++i) {
        EXPECT_EQ(first.capsules[i].p_a, second.capsules[i].p_a);
        EXPECT_EQ(first.capsules[i].p_b, second.capsules[i].p_b);
        EXPECT_EQ(first.capsules[i].radius_m, second.capsules[i].radius_m);
    }
}

TEST(FitCapsules, takes_a_flat_piece_a_needle_and_a_triangle_without_area) {
    const std::vector<SurfaceMesh> meshes{{{{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}}, {{0, 1, 2}}},
                                          {{{0, 0, 0}, {0.1, 0, 0}, {0.2, 0, 0}}, {{0, 1, 2}}},
                                          {{{0, 0, 0.3}}, {{0, 0, 0}}}};
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const BodyFit fit = fit_capsules(meshes[i]).value();
        EXPECT_FALSE(first_uncovered(meshes[i], fit.capsules, kCoveredWithin_m, kFitEdge_m)) << "shape " << i;
        EXPECT_LE(fit.measures.protrusion_max_m, 0.050) << "shape " << i;
    }
}

}  // namespace
}  // namespace octoskin
