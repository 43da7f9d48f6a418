#include <gtest/gtest.h>

#include "host/lab/evaluation/truth.hpp"
#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::evaluation {
namespace {

const Eigen::Isometry3d kAtOrigin = Eigen::Isometry3d::Identity();

/// One ray along a row of 0.1 m voxels: from the middle of voxel `from` to the middle of voxel `to`.
DepthView ray_along_x(int from, int to) {
    const auto middle = [](int voxel) { return (static_cast<float>(voxel) + 0.5F) * 0.1F; };
    return {Eigen::Vector3f(middle(from), 0.05F, 0.05F).cast<double>(),
            {Eigen::Vector3f(middle(to), 0.05F, 0.05F)}};
}

std::string as_text(const VoxelGrid<Occupancy>& truth) {
    std::string text;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        text += truth[i] == Occupancy::occupied ? '#' : truth[i] == Occupancy::free ? '.' : '?';
    }
    return text;
}

std::string truth_of(const std::vector<DepthView>& views, const Eigen::Isometry3d& T_map_base = kAtOrigin) {
    return as_text(camera_truth(Survey{views}, CameraTruthConfig{}, row(8), 0.1, T_map_base));
}

TEST(CameraTruth, frees_what_a_ray_passes_and_occupies_where_it_ends) {
    EXPECT_EQ(truth_of({ray_along_x(1, 5)}), "?....#??");
}

TEST(CameraTruth, of_no_view_is_unknown) {
    EXPECT_EQ(truth_of({}), "????????");
}

TEST(CameraTruth, cuts_rays_off_at_the_region) {
    EXPECT_EQ(truth_of({ray_along_x(-20, 4)}), "....#???");
    EXPECT_EQ(truth_of({ray_along_x(3, 40)}), "???.....");
}

TEST(CameraTruth, stands_where_the_world_stands_in_the_map) {
    Eigen::Isometry3d T_map_base = kAtOrigin;
    T_map_base.translation().x() = 0.2;
    EXPECT_EQ(truth_of({ray_along_x(1, 4)}, T_map_base), "???...#?");
}

TEST(CameraTruth, within_one_view_a_hit_wins_over_passing_rays) {
    DepthView view = ray_along_x(0, 3);
    for (int i = 0; i < 5; ++i) {
        view.p_base_points.push_back(ray_along_x(0, 6).p_base_points.front());
    }
    EXPECT_EQ(truth_of({view}), "...#..#?");
}

TEST(CameraTruth, one_view_gives_a_voxel_one_term_however_many_rays_say_so) {
    // Had the three hits of the first view counted each, two views could not outweigh them.
    DepthView hits = ray_along_x(0, 3);
    hits.p_base_points.resize(3, hits.p_base_points.front());
    EXPECT_EQ(truth_of({hits, ray_along_x(0, 6), ray_along_x(0, 6)}), "...#..#?");
    EXPECT_EQ(truth_of({hits, ray_along_x(0, 6), ray_along_x(0, 6), ray_along_x(0, 6)}), "......#?");
}

TEST(CameraTruth, clamps_after_every_view) {
    // Six hits would be 5.1, and nine misses 3.6 less; clamped at 3.5 in between, nine misses leave -0.1.
    std::vector<DepthView> views(6, ray_along_x(0, 3));
    views.insert(views.end(), 8, ray_along_x(0, 6));
    EXPECT_EQ(truth_of(views), "...#..#?");
    views.push_back(ray_along_x(0, 6));
    EXPECT_EQ(truth_of(views), "......#?");
}

TEST(CameraTruth, ignores_a_view_from_outside_the_octree) {
    DepthView far = ray_along_x(0, 3);
    far.p_base_camera.x() = 1e6;
    EXPECT_EQ(truth_of({far, ray_along_x(2, 5)}), "??...#??");
}

}  // namespace
}  // namespace octoskin::evaluation
