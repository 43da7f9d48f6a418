// The bricks of a box, from large cubes to small ones: most of them need never be looked at one by one.
#pragma once

#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Which of a cube's voxels are meant.
enum class CubeVerdict : std::uint8_t { none, some, all };

inline constexpr VoxelCube kWholeOctree{.lowest = {}, .height = 16};

/// Asks verdict_of(VoxelCube) of an octree's cubes that meet the box, large ones first; what is below a cube
/// is asked only if it says `some`. Calls visit(VoxelCube, bool is_all), in Morton order, for the largest
/// cubes that are meant whole and for those of `least_height` of which some voxels are. Recurses 13 deep at
/// most.
template <class VerdictOf, class Visit>
void walk_cubes(const KeyBox& box, unsigned least_height, const VerdictOf& verdict_of, const Visit& visit,
                const VoxelCube& cube = kWholeOctree) {
    if (!do_meet(cube, box)) return;
    // Of a cube that is larger than the box little can be said.
    const CubeVerdict verdict = cube.height > 9 ? CubeVerdict::some : verdict_of(cube);
    if (verdict == CubeVerdict::none) return;
    if (verdict == CubeVerdict::all || cube.height == least_height)
        return visit(cube, verdict == CubeVerdict::all);
    const MortonCode first = morton_of(cube.lowest);
    const unsigned height = cube.height - 1;
    for (MortonCode child = 0; child < 8; ++child) {
        walk_cubes(box, least_height, verdict_of, visit,
                   {key_of_morton(first + (child << (3 * height))), height});
    }
}

/// The same of bricks: calls visit(MortonCode brick, bool is_all) for each of which not `none` are meant.
template <class VerdictOf, class Visit>
void walk_bricks(const KeyBox& box, const VerdictOf& verdict_of, const Visit& visit,
                 const VoxelCube& below = kWholeOctree) {
    const auto visit_bricks = [&](const VoxelCube& cube, bool is_all) {
        const MortonCode first = morton_of(cube.lowest);
        const MortonCode end = first + (MortonCode{1} << (3 * cube.height));
        for (MortonCode brick = first; brick < end; brick += kBrickVoxels) visit(brick, is_all);
    };
    walk_cubes(box, kBrickHeight, verdict_of, visit_bricks, below);
}

}  // namespace octoskin
