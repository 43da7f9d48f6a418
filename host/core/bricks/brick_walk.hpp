// Visits the bricks of a box, from large cubes to small ones, so that most bricks need no test of their own.
#pragma once

#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Which of a cube's voxels are selected.
enum class CubeCoverage : std::uint8_t { none, some, all };

inline constexpr VoxelCube kWholeOctree{.lowest = {}, .height = 16};

/// Calls coverage_of(VoxelCube) for the octree's cubes that meet the box, large ones first; the children of a
/// cube are tested only if the result is `some`. Calls visit(VoxelCube, bool is_all), in Morton order, for
/// the largest cubes that are selected completely, and for those of `least_height` that are selected in part.
/// Recursion depth: 13 at most.
template <class CoverageOf, class Visit>
void walk_cubes(const KeyBox& box, unsigned least_height, const CoverageOf& coverage_of, const Visit& visit,
                const VoxelCube& cube = kWholeOctree) {
    if (!do_meet(cube, box)) return;
    // A cube that is larger than the box seldom has a single result.
    const CubeCoverage verdict = cube.height > 9 ? CubeCoverage::some : coverage_of(cube);
    if (verdict == CubeCoverage::none) return;
    if (verdict == CubeCoverage::all || cube.height == least_height)
        return visit(cube, verdict == CubeCoverage::all);
    const MortonCode first = morton_of(cube.lowest);
    const unsigned height = cube.height - 1;
    for (MortonCode child = 0; child < 8; ++child) {
        walk_cubes(box, least_height, coverage_of, visit,
                   {key_of_morton(first + (child << (3 * height))), height});
    }
}

/// The same for bricks: calls visit(MortonCode brick, bool is_all) for each brick with selected voxels.
template <class CoverageOf, class Visit>
void walk_bricks(const KeyBox& box, const CoverageOf& coverage_of, const Visit& visit,
                 const VoxelCube& below = kWholeOctree) {
    const auto visit_bricks = [&](const VoxelCube& cube, bool is_all) {
        const MortonCode first = morton_of(cube.lowest);
        const MortonCode end = first + (MortonCode{1} << (3 * cube.height));
        for (MortonCode brick = first; brick < end; brick += kBrickVoxels) visit(brick, is_all);
    };
    walk_cubes(box, kBrickHeight, coverage_of, visit_bricks, below);
}

}  // namespace octoskin
