// The bricks of a box, from large cubes to small ones: most of them need never be looked at one by one.
#pragma once

#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Which of a cube's voxels are meant.
enum class CubeVerdict : std::uint8_t { none, some, all };

/// Asks verdict_of(VoxelCube) of an octree's cubes that meet the box, large ones first; what is below a cube
/// is asked only if it says `some`. Calls visit(MortonCode brick, bool is_all) for each brick of which not
/// `none` are meant, in Morton order. Recurses 13 deep at most.
template <class VerdictOf, class Visit>
void walk_bricks(const KeyBox& box, const VerdictOf& verdict_of, const Visit& visit,
                 const VoxelCube& cube = {.lowest = {}, .height = 16}) {
    if (!do_meet(cube, box)) return;
    // Of a cube that is larger than the box little can be said.
    const CubeVerdict verdict = cube.height > 9 ? CubeVerdict::some : verdict_of(cube);
    if (verdict == CubeVerdict::none) return;
    const MortonCode first = morton_of(cube.lowest);
    if (cube.height == kBrickHeight) return visit(first, verdict == CubeVerdict::all);
    if (verdict == CubeVerdict::all) {
        const MortonCode end = first + (MortonCode{1} << (3 * cube.height));
        for (MortonCode brick = first; brick < end; brick += kBrickVoxels) visit(brick, true);
        return;
    }
    const unsigned height = cube.height - 1;
    for (MortonCode child = 0; child < 8; ++child) {
        walk_bricks(box, verdict_of, visit, {key_of_morton(first + (child << (3 * height))), height});
    }
}

}  // namespace octoskin
