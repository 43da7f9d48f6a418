#include "host/core/traversal/mark_grid.hpp"

#include <new>

namespace octoskin {

bool MarkGrid::span(VoxelKey lowest, VoxelKey highest, std::size_t voxels_max) {
    const std::array<int, 3> low = {lowest.x, lowest.y, lowest.z};
    const std::array<int, 3> high = {highest.x, highest.y, highest.z};
    std::array<int, 3> corner{};
    std::array<int, 3> size{};
    std::size_t voxels = 1;  // at most 65552 along each axis: the product fits 64 bits
    for (std::size_t i = 0; i < 3; ++i) {
        corner[i] = ((low[i] - 1 + kBrick) / kBrick - 1) * kBrick;
        size[i] = ((high[i] + 1 - corner[i]) / kBrick + 1) * kBrick;
        voxels *= static_cast<std::size_t>(size[i]);
    }
    if (voxels > voxels_max) return false;
    const std::size_t bytes = voxels + kBrick;
    if (bytes > capacity_) {
        forget();
        // Zeroes that the system has not to write before somebody marks them.
        marks_.reset(static_cast<std::uint8_t*>(std::calloc(bytes, 1)));
        if (marks_ == nullptr) throw std::bad_alloc();
        capacity_ = bytes;
    }
    corner_ = corner;
    size_ = size;
    stride_ = {1, size[0], std::ptrdiff_t{size[0]} * size[1]};
    voxels_ = voxels;
    return true;
}

void MarkGrid::forget() noexcept {
    marks_.reset();
    capacity_ = 0;
    voxels_ = 0;
}

}  // namespace octoskin
