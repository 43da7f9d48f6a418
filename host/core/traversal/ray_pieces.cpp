// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/ray_pieces.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/ray_pieces.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "host/core/traversal/lanes-inl.hpp"
#include "host/core/traversal/walkers-inl.hpp"

#ifndef OCTOSKIN_RAY_PIECES_TYPES
#define OCTOSKIN_RAY_PIECES_TYPES
namespace octoskin {

/// The bytes of a VisitedGrid.
struct GridMarks {
    std::uint8_t* marks = nullptr;
    double nowhere = 0.0;  ///< index for marks without effect
};

/// Added to a whole number below 2^51, it leaves the number as an integer in the low bits.
constexpr double kIntegerShift = 4503599627370496.0;  // 2^52
constexpr std::uint64_t kIntegerBits = (std::uint64_t{1} << 52U) - 1;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {

/// Marks the voxel of each lane. The additions keep an index whole.
HWY_INLINE void mark(Double index, std::uint8_t* marks) {
    const Doubles d;
    HWY_ALIGN std::array<double, hn::MaxLanes(Doubles())> shifted;
    hn::Store(hn::Add(index, hn::Set(d, kIntegerShift)), d, shifted.data());
    for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
        marks[std::bit_cast<std::uint64_t>(shifted[lane]) & kIntegerBits] = VisitedGrid::kPassed;
    }
}

template <class AnyWalkers>
void report_undecided(const AnyWalkers& walkers, const RayPiece* pieces, std::size_t count,
                      std::vector<std::uint32_t>& undecided) {
    const Doubles d;
    if (hn::AllFalse(d, walkers.is_undecided())) return;
    for_each_set(d, walkers.is_undecided(), [&](std::size_t lane) {
        if (lane < count) undecided.push_back(pieces[lane].pixel);
    });
}

/// Walks two vectors at a time: while one waits for its last sum, the other continues. If too few pieces are
/// left, the second repeats the first.
void walk_all(const Walk& walk, const GridMarks& grid, std::span<const RayPiece> pieces,
              std::vector<std::uint32_t>& undecided) {
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    const auto visit = [grid](Double index, Mask is_there) HWY_ATTR {
        mark(hn::IfThenElse(is_there, index, hn::Set(Doubles(), grid.nowhere)), grid.marks);
    };
    for (std::size_t first = 0; first < pieces.size(); first += 2 * lanes) {
        const std::size_t left = pieces.size() - first;
        const RayPiece* const some = pieces.data() + first;
        const RayPiece* const others = left > lanes ? some + lanes : some;
        const std::size_t count = std::min(lanes, left);
        const std::size_t other_count = left > lanes ? std::min(lanes, left - lanes) : 1;
        Walkers a(walk, some, count, visit);
        Walkers b(walk, others, other_count, visit);
        while (!a.have_ended() || !b.have_ended()) {
            a.step();
            b.step();
        }
        report_undecided(a, some, count, undecided);
        if (left > lanes) report_undecided(b, others, other_count, undecided);
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(walk_all);

}  // namespace

Walk walk_of(const ProjectedImage& image, const VoxelLattice& lattice, const VoxelNumbers& numbers,
             double faces_max) {
    const auto origin = lattice.key_of(image.origin.cast<double>());
    assert(origin.has_value());
    const std::array<const float*, 3> ends = {image.end_x.data(), image.end_y.data(), image.end_z.data()};
    const std::array<std::uint16_t, 3> keys = {origin->x, origin->y, origin->z};
    Walk walk{.axes = {},
              .resolution_m = lattice.resolution_m(),
              .voxels_per_m = 1.0 / lattice.resolution_m(),
              .first = numbers.first,
              .reach_m = image.reach_m.data()};
    for (std::size_t i = 0; i < 3; ++i) {
        walk.axes[i] = {.end = ends[i],
                        .origin = image.origin[static_cast<Eigen::Index>(i)],
                        .floored_origin = keys[i] - static_cast<double>(kOriginKey),
                        .half_edge_m = static_cast<double>(static_cast<float>(lattice.resolution_m() * 0.5)),
                        .stride = numbers.strides[i]};
    }
    // A sum of n distances up to s has an error of at most n * s * 2^-53, in any order of additions; a
    // product has a smaller one.
    walk.error_m =
        4.0 * faces_max * faces_max * lattice.resolution_m() * std::numeric_limits<double>::epsilon();
    return walk;
}

void walk_pieces(const ProjectedImage& image, const VoxelLattice& lattice, std::span<const RayPiece> pieces,
                 VisitedGrid& grid, std::vector<std::uint32_t>& undecided) {
    const auto origin = lattice.key_of(image.origin.cast<double>());
    assert(origin.has_value());
    VoxelNumbers numbers{.first = static_cast<double>(grid.index_of(*origin))};
    double faces_max = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        numbers.strides[i] = static_cast<double>(grid.stride()[i]);
        faces_max += static_cast<double>(grid.size()[i]);
    }
    const Walk walk = walk_of(image, lattice, numbers, faces_max);
    HWY_DYNAMIC_DISPATCH(walk_all)
    (walk, {grid.marks(), static_cast<double>(grid.nowhere())}, pieces, undecided);
}

}  // namespace octoskin
#endif
