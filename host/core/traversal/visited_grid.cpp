#include "host/core/traversal/visited_grid.hpp"

#include <cstring>
#include <new>

namespace octoskin {
namespace {

/// Four voxels of a row along x, by their bits, as places in a word of a BrickMask.
constexpr std::array<std::uint64_t, 16> kRowPlaces = [] {
    std::array<std::uint64_t, 16> places{};
    for (unsigned bits = 0; bits < 16; ++bits) {
        for (unsigned x = 0; x < 4; ++x) {
            if ((bits >> x & 1U) != 0) places[bits] |= std::uint64_t{1} << ((x & 1U) | (x & 2U) << 2U);
        }
    }
    return places;
}();

/// Collects bit 0 of eight bytes; the first byte gives the lowest bit.
constexpr unsigned low_bits_of(std::uint64_t eight) {
    return static_cast<unsigned>(((eight & 0x0101010101010101ULL) * 0x0102040810204080ULL) >> 56U);
}

void put_row(BrickMask& mask, unsigned bits, unsigned y, unsigned z) {
    const unsigned word = ((y >> 2U) << 1U) | ((z >> 2U) << 2U);
    const unsigned place = (y & 1U) << 1U | (y & 2U) << 3U | (z & 1U) << 2U | (z & 2U) << 4U;
    mask[word] |= kRowPlaces[bits & 15U] << place;
    mask[word + 1] |= kRowPlaces[bits >> 4U] << place;
}

}  // namespace

bool VisitedGrid::span(VoxelKey lowest, VoxelKey highest, std::size_t voxels_max) {
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
        // calloc: the system need not write the zeroes before a mark is set.
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

BrickMask VisitedGrid::take_brick(VoxelKey lowest) noexcept {
    static_assert(kPassed == 1);
    BrickMask passed{};
    std::uint8_t* const first = marks_.get() + index_of(lowest);
    for (unsigned z = 0; z < kBrick; ++z) {
        for (unsigned y = 0; y < kBrick; ++y) {
            std::uint8_t* const row = first + y * stride_[1] + z * stride_[2];
            std::uint64_t eight = 0;
            std::memcpy(&eight, row, sizeof(eight));
            if (eight == 0) continue;
            put_row(passed, low_bits_of(eight), y, z);
            std::memset(row, 0, sizeof(eight));
        }
    }
    return passed;
}

void VisitedGrid::clear_beyond_keys(const KeyBox& box) noexcept {
    const auto is_whole = [&](int low, int high, std::size_t axis) {
        return low == corner_[axis] && high == corner_[axis] + size_[axis] - 1;
    };
    if (is_whole(box.lowest.x, box.highest.x, 0) && is_whole(box.lowest.y, box.highest.y, 1) &&
        is_whole(box.lowest.z, box.highest.z, 2)) {
        return;
    }
    std::memset(marks_.get(), 0, voxels_);
}

void VisitedGrid::forget() noexcept {
    marks_.reset();
    capacity_ = 0;
    voxels_ = 0;
}

}  // namespace octoskin
