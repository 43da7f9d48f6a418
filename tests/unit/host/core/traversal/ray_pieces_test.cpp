#include "host/core/traversal/ray_pieces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/cases.hpp"
#include "tests/unit/host/core/traversal/traversal_scene.hpp"

namespace octoskin {
namespace {

constexpr float kEnd = std::numeric_limits<float>::infinity();

/// Ends that a camera would not give: rays along axes, planes and diagonals, of no length, of a few voxels.
ProjectedImage nasty_rays(unsigned seed, const VoxelLattice& lattice) {
    property::RandomGeometry random(seed, lattice.resolution_m());
    ProjectedImage image;
    image.width = 500;
    image.height = 1;
    image.origin = random.point(3.0);
    image.lowest = image.highest = image.origin;
    for (std::uint32_t i = 0; i < image.width; ++i) {
        const Eigen::Vector3f end = random.end_from(image.origin, 3.0);
        image.end_x.push_back(end.x());
        image.end_y.push_back(end.y());
        image.end_z.push_back(end.z());
        image.range_m.push_back(0.0);
        // As if each were seen straight ahead: the depth of an end is its distance.
        image.reach_m.push_back(std::max((end - image.origin).norm(), 1e-6F));
        image.lowest = image.lowest.cwiseMin(end);
        image.highest = image.highest.cwiseMax(end);
    }
    return image;
}

TEST(RayPieces, of_whole_rays_are_what_octomap_visits_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        for (unsigned seed = 0; seed < testing_support::cases(4); ++seed) {
            const VoxelLattice lattice(seed % 2 == 0 ? 0.04 : 0.1);
            const ProjectedImage image = nasty_rays(seed, lattice);
            VisitedGrid grid;
            span(grid, image, lattice);
            std::vector<RayPiece> pieces;
            for (std::uint32_t i = 0; i < image.width; ++i) pieces.push_back({i, 0.0F, kEnd});
            std::vector<std::uint32_t> undecided;
            walk_pieces(image, lattice, pieces, grid, undecided);
            ASSERT_TRUE(undecided.empty());
            ASSERT_EQ(drained(grid), walked(image, lattice)) << name << " seed " << seed;
        }
    });
}

TEST(RayPieces, put_together_are_the_whole_ray_or_the_ray_is_named) {
    std::size_t named = 0;
    std::size_t rays = 0;
    on_each_instruction_set([&](const std::string& name) {
        for (unsigned seed = 100; seed < 100 + testing_support::cases(2); ++seed) {
            const VoxelLattice lattice(0.04);
            const ProjectedImage image = nasty_rays(seed, lattice);
            property::RandomGeometry random(seed, 0.04);
            VisitedGrid grid;
            span(grid, image, lattice);
            for (std::uint32_t i = 0; i < image.width; i += 41) {
                ProjectedImage one = image;
                for (std::uint32_t j = 0; j < image.width; ++j) {
                    if (j != i) one.reach_m[j] = -1.0F;
                }
                const auto cut = static_cast<float>(random.uniform(0.0, static_cast<double>(one.reach_m[i])));
                std::vector<std::uint32_t> undecided;
                walk_pieces(one, lattice, std::vector<RayPiece>{{i, 0.0F, cut}, {i, cut, kEnd}}, grid,
                            undecided);
                const std::set<VoxelKey> marked = drained(grid);
                const std::set<VoxelKey> truth = walked(one, lattice);
                ++rays;
                if (!undecided.empty()) {
                    ++named;
                    ASSERT_TRUE(std::includes(truth.begin(), truth.end(), marked.begin(), marked.end()));
                    continue;
                }
                ASSERT_EQ(marked, truth) << name << " seed " << seed << " ray " << i << " cut " << cut;
            }
        }
    });
    EXPECT_LT(named, rays / 3);
}

TEST(RayPieces, of_a_ray_through_corner_after_corner_name_it_and_mark_nothing_beside_it) {
    on_each_instruction_set([](const std::string& name) {
        const VoxelLattice lattice(0.25);
        ProjectedImage image;
        image.width = image.height = 1;
        image.end_x = image.end_y = image.end_z = {2.125F};
        image.range_m = {1.0};
        image.reach_m = {2.125F};
        image.highest = Eigen::Vector3f::Constant(2.125F);
        VisitedGrid grid;
        span(grid, image, lattice);
        std::vector<std::uint32_t> undecided;
        walk_pieces(image, lattice, std::vector<RayPiece>{{0, 1.1F, kEnd}}, grid, undecided);
        EXPECT_EQ(undecided, std::vector<std::uint32_t>{0}) << name;
        const std::set<VoxelKey> marked = drained(grid);
        const std::set<VoxelKey> truth = walked(image, lattice);
        EXPECT_TRUE(std::includes(truth.begin(), truth.end(), marked.begin(), marked.end())) << name;
    });
}

}  // namespace
}  // namespace octoskin
