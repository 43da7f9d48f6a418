#include "host/lab/evaluation/voxel_grid.hpp"

#include <algorithm>

namespace octoskin::evaluation {
namespace {

/// Grows a mask along one axis: `stride` between neighbours, `length` voxels in a row.
void dilate_axis(VoxelMask& mask, std::size_t stride, std::size_t length, std::size_t reach) {
    std::vector<char> row(length);
    for (std::size_t first = 0; first < mask.size(); ++first) {
        if (first / stride % length != 0) {
            continue;
        }
        for (std::size_t i = 0; i < length; ++i) {
            row[i] = mask[first + i * stride];
        }
        // `covered` is the number of leading voxels that some set voxel before them already reaches.
        std::size_t covered = 0;
        for (std::size_t i = 0; i < length; ++i) {
            if (row[i] == 0) {
                continue;
            }
            const std::size_t from = std::max(covered, i - std::min(i, reach));
            covered = std::min(length, i + reach + 1);
            for (std::size_t j = from; j < covered; ++j) {
                mask[first + j * stride] = 1;
            }
        }
    }
}

}  // namespace

KeyBox KeyBox::padded(std::uint16_t voxels) const noexcept {
    const auto lower = [voxels](std::uint16_t key) {
        return static_cast<std::uint16_t>(key - std::min(key, voxels));
    };
    const auto higher = [voxels](std::uint16_t key) {
        return static_cast<std::uint16_t>(std::min<std::uint32_t>(std::uint32_t{key} + voxels, 0xFFFFU));
    };
    return {{lower(min.x), lower(min.y), lower(min.z)}, {higher(max.x), higher(max.y), higher(max.z)}};
}

VoxelMask dilated(const VoxelMask& mask, std::uint16_t voxels) {
    VoxelMask grown = mask;
    const auto [nx, ny, nz] = mask.box().shape();
    dilate_axis(grown, 1, nx, voxels);
    dilate_axis(grown, nx, ny, voxels);
    dilate_axis(grown, nx * ny, nz, voxels);
    return grown;
}

}  // namespace octoskin::evaluation
