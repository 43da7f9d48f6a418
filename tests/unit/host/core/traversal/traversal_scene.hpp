// Images, poses and what their rays pass, walked one by one.
#pragma once

#include <bit>
#include <cmath>
#include <set>

#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/visited_grid.hpp"
#include "host/core/voxels/ray_walk.hpp"
#include "tests/property/mapping/random_geometry.hpp"
#include "tests/support/instruction_sets.hpp"

namespace octoskin {

inline constexpr CameraIntrinsics kSmallCamera{
    .width = 64, .height = 53, .fx = 45.6, .fy = 45.6, .cx = 32.0, .cy = 26.5};

/// Calls visit(key) for what walk_ray_keys() visits, ray by ray.
template <class Visit>
void walk_all(const ProjectedImage& image, const VoxelLattice& lattice, const Visit& visit) {
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        if (image.reach_m[i] < 0.0F) continue;
        const auto ray = plan_ray(lattice, image.origin, {image.end_x[i], image.end_y[i], image.end_z[i]});
        walk_ray_keys(*ray, visit);
    }
}

inline std::set<VoxelKey> walked(const ProjectedImage& image, const VoxelLattice& lattice) {
    std::set<VoxelKey> voxels;
    walk_all(image, lattice, [&](VoxelKey key) { voxels.insert(key); });
    return voxels;
}

inline void span(VisitedGrid& grid, const ProjectedImage& image, const VoxelLattice& lattice) {
    ASSERT_TRUE(grid.span(*lattice.key_of(image.lowest.cast<double>()),
                          *lattice.key_of(image.highest.cast<double>()), std::size_t{1} << 30U));
}

inline std::set<VoxelKey> drained(VisitedGrid& grid) {
    std::set<VoxelKey> voxels;
    grid.drain([&](MortonCode brick, const BrickMask& passed) {
        for (std::size_t word = 0; word < passed.size(); ++word) {
            for (std::uint64_t bits = passed[word]; bits != 0; bits &= bits - 1) {
                const auto cell = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
                EXPECT_TRUE(voxels.insert(key_of_morton(brick + cell)).second);
            }
        }
    });
    return voxels;
}

}  // namespace octoskin
