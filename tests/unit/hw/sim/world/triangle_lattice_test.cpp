// Oracle: every point of the lattice, one by one, as a loop over the whole triangle has them.
#include "hw/sim/world/triangle_lattice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace octoskin::sim {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;
using Points = std::vector<Eigen::Vector3d>;

Points all_points(Corners abc, double pitch_m) {
    const auto length = [&](std::size_t i) { return (abc[(i + 1) % 3] - abc[i]).norm(); };
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i) longest = length(i) > length(longest) ? i : longest;
    std::rotate(abc.begin(), abc.begin() + static_cast<std::ptrdiff_t>(longest), abc.end());
    const auto& [a, b, c] = abc;
    Points points;
    const int rows = std::max(1, static_cast<int>(std::ceil((b - a).norm() / pitch_m)));
    for (int row = 0; row <= rows; ++row) {
        const double part = static_cast<double>(row) / rows;
        const Eigen::Vector3d from = a + part * (b - a);
        const Eigen::Vector3d to = c + part * (b - c);
        const int steps = static_cast<int>(std::ceil((to - from).norm() / pitch_m));
        for (int step = 0; step <= steps; ++step)
            points.emplace_back(
                steps == 0 ? from
                           : Eigen::Vector3d(from + (to - from) * (static_cast<double>(step) / steps)));
    }
    return points;
}

Points within(const Points& points, const Eigen::AlignedBox3d& region) {
    Points kept;
    std::ranges::copy_if(points, std::back_inserter(kept),
                         [&](const Eigen::Vector3d& point) { return region.contains(point); });
    return kept;
}

Points near(const TriangleLattice& lattice, const Eigen::AlignedBox3d& region) {
    Points points;
    lattice.for_each_near(region, [&](const Eigen::Vector3d& point) { points.push_back(point); });
    return points;
}

Eigen::AlignedBox3d box_of(const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return {p.cwiseMin(q), p.cwiseMax(q)};
}

TEST(TriangleLattice, has_the_same_points_in_a_region_as_without_one) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> at(-1.0, 1.0);
    // On the pitch, so that corners, rows and borders of regions fall on one another.
    std::uniform_int_distribution<int> on_pitch(-16, 16);
    std::size_t found = 0;
    for (int round = 0; round < 2000; ++round) {
        const auto point = [&]() -> Eigen::Vector3d {
            if (round % 2 == 0) return {at(random), at(random), at(random)};
            return 0.0625 * Eigen::Vector3d(on_pitch(random), on_pitch(random), on_pitch(random) / 8);
        };
        const Corners corners{point(), point(), point()};
        if ((corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() < 1e-6) continue;
        const auto region = box_of(point(), point());
        const Points expected = within(all_points(corners, 0.0625), region);
        const Points visited = near(TriangleLattice(corners, 0.0625), region);
        ASSERT_EQ(within(visited, region), expected) << "round " << round;
        found += expected.size();
    }
    EXPECT_GT(found, 10'000U);
}

TEST(TriangleLattice, has_all_its_points_in_a_region_without_end) {
    const Corners corners{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0.2), Eigen::Vector3d(0.3, 1, 0)};
    const Eigen::Vector3d far = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    const TriangleLattice lattice(corners, 0.01);
    EXPECT_EQ(near(lattice, {-far, far}), all_points(corners, 0.01));
    EXPECT_NEAR(lattice.count_near({-far, far}), static_cast<double>(all_points(corners, 0.01).size()), 300);
}

TEST(TriangleLattice, of_any_size_visits_little_more_than_what_the_region_holds) {
    const Eigen::AlignedBox3d region(Eigen::Vector3d(-0.5, -0.4, -0.5), Eigen::Vector3d(0.5, 0.4, 0.5));
    for (const double half_m : {50.0, 5e3, 5e5, 5e8}) {
        const Corners corners{Eigen::Vector3d(-half_m, -half_m, 0), Eigen::Vector3d(half_m, -half_m, 0),
                              Eigen::Vector3d(half_m, half_m, 0)};
        const TriangleLattice lattice(corners, 0.008);
        const double expected = 0.8 / (0.008 * 0.008) * std::sqrt(2.0) / 2.0;  // below the diagonal
        const Points points = near(lattice, region);
        const auto slack_m = 1e-9 * half_m;
        const double most = 1.2 * expected * (1.0 + 3.0 * slack_m) * (1.0 + 3.0 * slack_m) + 500.0;
        EXPECT_GE(static_cast<double>(within(points, region).size()), 0.9 * expected) << half_m;
        EXPECT_LE(static_cast<double>(points.size()), most) << half_m;
        EXPECT_NEAR(lattice.count_near(region), static_cast<double>(points.size()),
                    0.1 * static_cast<double>(points.size()))
            << half_m;
    }
}

TEST(TriangleLattice, beside_the_region_visits_nothing) {
    const Corners corners{Eigen::Vector3d(-1e9, -1e9, 2), Eigen::Vector3d(1e9, -1e9, 2),
                          Eigen::Vector3d(1e9, 1e9, 2)};
    const Eigen::AlignedBox3d below(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 0.5));
    EXPECT_TRUE(near(TriangleLattice(corners, 0.008), below).empty());
    EXPECT_EQ(TriangleLattice(corners, 0.008).count_near(below), 0.0);
}

}  // namespace
}  // namespace octoskin::sim
