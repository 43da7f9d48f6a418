// Oracle: golden section along the segment.
#include "host/core/query/segment_cube.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/cases.hpp"
#include "tests/support/sampled_distance.hpp"

namespace octoskin {
namespace {

const Eigen::Vector3d kCentre(1.0, 2.0, 3.0);

double distance(const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b) {
    return SegmentToCubes(p_a, p_b).distance(kCentre, 0.5);
}

TEST(SegmentCube, tells_the_way_to_a_face_an_edge_and_a_corner) {
    EXPECT_DOUBLE_EQ(distance({1.2, 2.1, 5.0}, {1.2, 2.1, 4.0}), 0.5);
    EXPECT_DOUBLE_EQ(distance({4.5, 6.5, 0.0}, {4.5, 6.5, 9.0}), 5.0);             // edge: 3 and 4 beyond
    EXPECT_DOUBLE_EQ(distance({3.5, 4.5, 4.5}, {9.0, 9.0, 9.0}), 3.0);             // corner: 2, 2 and 1
    EXPECT_DOUBLE_EQ(distance({2.0, 4.0, 3.1}, {4.0, 2.0, 3.1}), std::sqrt(2.0));  // between the ends
}

TEST(SegmentCube, is_none_where_they_meet) {
    EXPECT_EQ(distance({1.0, 2.0, 3.0}, {9.0, 9.0, 9.0}), 0.0);         // begins inside
    EXPECT_EQ(distance({-9.0, 2.0, 3.0}, {9.0, 2.0, 3.0}), 0.0);        // passes through
    EXPECT_EQ(distance({1.5, 0.0, 3.5}, {1.5, 9.0, 3.5}), 0.0);         // along an edge
    EXPECT_EQ(distance({1.5, 2.5, 3.5}, {1.5, 2.5, 3.5}), 0.0);         // a point, in a corner
    EXPECT_DOUBLE_EQ(distance({1.0, 2.0, 4.0}, {1.0, 2.0, 4.0}), 0.5);  // a point
}

TEST(SegmentCube, is_found_as_by_trying_and_never_less_than_its_bound) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
    std::size_t apart = 0;
    for (unsigned i = 0; i < testing_support::cases(20'000); ++i) {
        const double half_edge = 0.25 + 0.25 * anywhere(random) * (i % 3);
        Eigen::Vector3d p_a(anywhere(random), anywhere(random), anywhere(random));
        Eigen::Vector3d p_b(anywhere(random), anywhere(random), anywhere(random));
        if (i % 4 == 1) p_b[i % 3] = p_a[i % 3];              // parallel to a face
        if (i % 4 == 2) p_a[i % 3] = p_b[i % 3] = half_edge;  // in a face's plane
        if (i % 16 == 3) p_b = p_a + 1e-160 * p_b;            // its square is not even a number
        const Eigen::Vector3d centre = 0.5 * Eigen::Vector3d::Constant(anywhere(random));
        const SegmentToCubes segment(p_a + centre, p_b + centre);
        const double found = segment.distance(centre, std::abs(half_edge));
        const double tried = sampled_distance(p_a + centre, p_b + centre, centre, std::abs(half_edge));
        ASSERT_NEAR(found, tried, 1e-11) << i;
        const double bound = segment.distance_at_least(centre, std::abs(half_edge));
        ASSERT_FALSE(bound > found + 1e-14) << i << ": " << bound << " and " << found;
        apart += bound > 0.5 * found ? 1U : 0U;
    }
    EXPECT_GT(apart, testing_support::cases(20'000) / 4) << "a bound of nothing is no bound";
}

TEST(SegmentCube, is_as_exact_for_a_segment_of_a_thousand_kilometres) {
    const SegmentToCubes segment({-1e6, 0.03, 0.0}, {1e6, 0.03, 0.0});
    EXPECT_NEAR(segment.distance({0.0, 0.0, 0.0}, 0.02), 0.01, 1e-9);
    EXPECT_NEAR(segment.distance({777.7, 0.0, 0.0}, 0.02), 0.01, 1e-9);
    EXPECT_LE(segment.distance_at_least({777.7, 0.0, 0.0}, 0.02), 0.01 + 1e-9);
}

}  // namespace
}  // namespace octoskin
