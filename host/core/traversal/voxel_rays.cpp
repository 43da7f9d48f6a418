// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/voxel_rays.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/voxel_rays.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/traversal/lanes-inl.hpp"
#include "host/core/traversal/voxel_pixels-inl.hpp"
#include "host/core/traversal/word_coverage-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Returns the voxels of whose rays one possibly continues, and stores the pixels of each.
HWY_INLINE std::uint64_t ask_window(const Kernel& rays, const SquareOfPixels& square, const Centre& first,
                                    std::size_t word_cell, NearPixels& near_pixels) {
    const Tag f;
    const Lanes half = hn::Set(f, square.half_px);
    WordLookUps longest_m;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
        const Centres centres = centres_of(rays, first, word_cell + bit);
        const Pixels centre = pixels_at(rays, centres);
        near_pixels.put(bit, rays, centre, centres.z, rays.near_centre_m);
        longest_m.put(bit, places_of<1>(rays.blocks_width, {within(hn::Sub(centre.u, half), rays.last_u),
                                                            within(hn::Sub(centre.v, half), rays.last_v)}));
    }
    if (square.longest_m == nullptr) return ~std::uint64_t{0};
    longest_m.look_up(square.longest_m);
    std::uint64_t may_pass = 0;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
        const Lanes z = centres_of(rays, first, word_cell + bit).z;
        may_pass |= bits_of(f, hn::Gt(longest_m.values(bit), hn::Add(z, hn::Set(f, rays.margin_m)))) << bit;
    }
    return may_pass;
}

/// Calls visit(mask of the lanes, first column, row) for one vector of pixels after the other until it
/// returns true.
template <class Visit>
HWY_INLINE bool visit_pixels(const SeenPixels& seen, Visit&& visit) {
    const Tag f;
    for (int v = seen.v_first; v <= seen.v_last; ++v) {
        for (int u = seen.u_first; u <= seen.u_last; u += static_cast<int>(hn::Lanes(f))) {
            if (visit(hn::FirstN(f, static_cast<std::size_t>(seen.u_last + 1 - u)), u, v)) return true;
        }
    }
    return false;
}

/// True if one of a voxel's rays possibly continues. Combines all rows in one test, because for most voxels
/// no ray does.
HWY_INLINE bool may_any_pass(const Kernel& rays, const Centre& centre, const SeenPixels& seen) {
    const Tag f;
    const Lanes beyond = hn::Set(f, centre.z + rays.margin_m);
    for (int u = seen.u_first; u <= seen.u_last; u += static_cast<int>(hn::Lanes(f))) {
        Lanes furthest = hn::Zero(f);
        for (int v = seen.v_first; v <= seen.v_last; ++v)
            furthest = hn::Max(furthest, loaded(rays, rays.passed_m, u, v));
        const auto in_row = hn::FirstN(f, static_cast<std::size_t>(seen.u_last + 1 - u));
        if (!hn::AllFalse(f, hn::And(in_row, hn::Gt(furthest, beyond)))) return true;
    }
    return false;
}

HWY_INLINE bool is_any_passing(const Kernel& rays, const Centre& centre, const SeenPixels& seen) {
    const Tag f;
    if (!may_any_pass(rays, centre, seen)) return false;
    const Lanes beyond = hn::Set(f, centre.z + rays.margin_m);
    return visit_pixels(seen, [&](auto in_row, int u, int v) HWY_ATTR {
        const auto is_passing = hn::And(in_row, hn::Gt(loaded(rays, rays.passed_m, u, v), beyond));
        if (hn::AllFalse(f, is_passing)) return false;
        const Lanes z = hn::Set(f, centre.z);
        const Lanes off_x =
            off_by(hn::Iota(f, static_cast<float>(u)), rays.u_centre, rays.per_fx, z, hn::Set(f, centre.x));
        const Lanes off_y =
            off_by(hn::Set(f, static_cast<float>(v)), rays.v_centre, rays.per_fy, z, hn::Set(f, centre.y));
        return !hn::AllFalse(f, hn::And(is_passing, is_inside(rays, off_x, off_y)));
    });
}

/// VoxelRays::passed() for the brick whose first voxel's centre is at `first`.
void find_passed(const Kernel& rays, const SquareOfPixels& square, const Centre& first, const BrickMask& ends,
                 BrickMask& mask) {
    const WordCoverage verdicts = judge_words(rays, first);
    for (std::size_t number = 0; number < mask.size(); ++number) {
        std::uint64_t& word = mask[number];
        const bool is_all = (verdicts.all >> number & 1U) != 0;
        word = is_all ? ~std::uint64_t{0} : 0;
        if (is_all || (verdicts.none >> number & 1U) != 0) continue;
        const std::size_t word_cell = 64 * number;
        const Passed passed = ask_nearest(rays, first, word_cell);
        word = passed.certainly;
        std::uint64_t open = passed.is_before & ~word & ~ends[number];
        if (open == 0) continue;
        NearPixels near_pixels;
        open &= ask_window(rays, square, first, word_cell, near_pixels);
        for (; open != 0; open &= open - 1) {
            const auto bit = static_cast<unsigned>(__builtin_ctzll(open));
            const std::size_t at = word_cell + bit;
            const Centre centre{first.x + rays.offsets[0][at], first.y + rays.offsets[1][at],
                                first.z + rays.offsets[2][at]};
            if (is_any_passing(rays, centre, near_pixels.of(bit))) word |= std::uint64_t{1} << bit;
        }
    }
}

/// The votes of one voxel's rays.
HWY_INLINE RayVote vote_of(const Kernel& rays, float z, const SeenPixels& seen) {
    const Tag f;
    const Lanes begin = hn::Set(f, z - rays.half_depth_m);
    const Lanes end = hn::Set(f, z + rays.end_m);
    RayVote vote;
    (void)visit_pixels(seen, [&](auto in_row, int u, int v) HWY_ATTR {
        const Lanes reach = loaded(rays, rays.reach_m, u, v);
        const auto is_beyond = hn::Gt(reach, end);
        vote.go_on += static_cast<std::uint32_t>(hn::CountTrue(f, hn::And(in_row, is_beyond)));
        vote.end += static_cast<std::uint32_t>(
            hn::CountTrue(f, hn::And(in_row, hn::AndNot(is_beyond, hn::Ge(reach, begin)))));
        return false;
    });
    return vote;
}

/// Implements VoxelRays::vote_on().
void count_votes(const Kernel& rays, const Centre& first, const BrickMask& voxels, RayVote* votes) {
    const Tag f;
    for (std::size_t number = 0; number < voxels.size(); ++number) {
        if (voxels[number] == 0) continue;
        NearPixels near_pixels;
        const std::size_t word_cell = 64 * number;
        for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
            const Centres centres = centres_of(rays, first, word_cell + bit);
            near_pixels.put(bit, rays, pixels_at(rays, centres), centres.z, rays.half_edge_m);
        }
        for (std::uint64_t left = voxels[number]; left != 0; left &= left - 1) {
            const auto bit = static_cast<unsigned>(__builtin_ctzll(left));
            const std::size_t cell = word_cell + bit;
            const float z = first.z + rays.offsets[2][cell];
            votes[cell] = z > rays.near_m ? vote_of(rays, z, near_pixels.of(bit)) : RayVote();
        }
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_passed);
HWY_EXPORT(count_votes);

/// In edges. A filtered depth with 3 cm of noise still has an error of 0.6 cm. With 0.5, a surface just
/// behind a voxel would sometimes mark the voxel occupied; with 0, a surface in the voxel's farther half is
/// not detected (docs/results/notebook-2026-11.md).
constexpr double kEndsBehindCentre = 0.2;

/// In edges. Rays nearer to a voxel's corners graze neighbouring voxels: they would free surfaces
/// (docs/results/notebook-2026-11.md).
constexpr double kNearCentre = 0.45;

}  // namespace

void VoxelRays::begin(const CertainView& view, const ProjectedImage& image, const RangePyramid& reach,
                      const VoxelLattice& lattice) {
    view_ = &view;
    reach_ = &reach;
    lattice_ = &lattice;
    const CameraIntrinsics& camera = view.camera;
    const Eigen::Matrix3d R_camera_map = view.T_camera_map.linear();
    kernel_.passed_m = image.passed_m.data();
    kernel_.reach_m = image.reach_m.data();
    kernel_.width = camera.width;
    kernel_.height = camera.height;
    kernel_.last_u = static_cast<float>(camera.width - 1);
    kernel_.last_v = static_cast<float>(camera.height - 1);
    kernel_.fx = static_cast<float>(camera.fx);
    kernel_.fy = static_cast<float>(camera.fy);
    kernel_.per_fx = static_cast<float>(1.0 / camera.fx);
    kernel_.per_fy = static_cast<float>(1.0 / camera.fy);
    kernel_.u_centre = static_cast<float>(camera.cx - 0.5);
    kernel_.v_centre = static_cast<float>(camera.cy - 0.5);
    // A voxel's centre is up to three halves of an edge from the middle, and its side another half.
    kernel_.word_x_m = static_cast<float>(2.0 * view.resolution_m * R_camera_map.row(0).lpNorm<1>());
    kernel_.word_y_m = static_cast<float>(2.0 * view.resolution_m * R_camera_map.row(1).lpNorm<1>());
    kernel_.word_depth_m = 3.0F * static_cast<float>(view.half_depth_m);
    kernel_.inside_m = static_cast<float>(0.5 * view.resolution_m - view.margin_m);
    kernel_.near_centre_m = static_cast<float>(kNearCentre * view.resolution_m);
    kernel_.half_edge_m = static_cast<float>(0.5 * view.resolution_m);
    kernel_.half_depth_m = static_cast<float>(view.half_depth_m);
    kernel_.end_m = static_cast<float>(kEndsBehindCentre * view.resolution_m);
    kernel_.near_m = static_cast<float>(view.half_depth_m + view.margin_m);
    kernel_.margin_m = static_cast<float>(view.margin_m);
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        const VoxelKey at = key_of_morton(cell);
        const Eigen::Vector3d offset = view.resolution_m * R_camera_map * Eigen::Vector3d(at.x, at.y, at.z);
        for (std::size_t i = 0; i < 3; ++i)
            kernel_.offsets[i][cell] = static_cast<float>(offset[static_cast<Eigen::Index>(i)]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = static_cast<Eigen::Index>(i);
        kernel_.across[i] = {static_cast<float>(R_camera_map(0, axis)),
                             static_cast<float>(R_camera_map(1, axis))};
    }
    for (std::size_t word = 0; word < 8; ++word) {
        for (std::size_t i = 0; i < 3; ++i)
            kernel_.middles[i][word] =
                0.5F * (kernel_.offsets[i][64 * word] + kernel_.offsets[i][64 * word + 63]);
    }
    kernel_.depth_max_m = static_cast<float>(view.depth_max_m);
    kernel_.blocks_width = reach.columns();
    for (std::uint32_t k = 0; k < RangePyramid::kLevels; ++k) {
        kernel_.shortest_m[k] = reach.level(k).shortest.data();
        kernel_.longest_m[k] = reach.level(k).longest.data();
    }
}

VoxelRays::Brick VoxelRays::brick_at(VoxelKey lowest) const {
    const Eigen::Vector3f p = (view_->T_camera_map * lattice_->centre_of(lowest)).cast<float>();
    return {p.x(), p.y(), p.z()};
}

BrickMask VoxelRays::passed(const Brick& brick, const BrickMask& ends) const {
    BrickMask mask;
    const float* const z_offsets = kernel_.offsets[2].data();
    const float nearest_m =
        brick.z + std::min({z_offsets[0], z_offsets[73], z_offsets[146], z_offsets[219], z_offsets[292],
                            z_offsets[365], z_offsets[438], z_offsets[511]});
    // A square that contains the pixels of each voxel's rays.
    SquareOfPixels square;
    if (nearest_m > 0.0F) {
        constexpr float kRounding_px = 0.01F;
        square = reach_->square(std::max(kernel_.fx, kernel_.fy) * kernel_.near_centre_m / nearest_m +
                                kRounding_px);
    }
    HWY_DYNAMIC_DISPATCH(find_passed)
    (kernel_, square, {brick.x, brick.y, brick.z}, ends, mask);
    return mask;
}

void VoxelRays::vote_on(const Brick& brick, const BrickMask& voxels,
                        std::span<RayVote, kBrickVoxels> votes) const {
    HWY_DYNAMIC_DISPATCH(count_votes)(kernel_, {brick.x, brick.y, brick.z}, voxels, votes.data());
}

float VoxelRays::range_m(const Brick& brick, std::size_t cell) const noexcept {
    const float x = brick.x + kernel_.offsets[0][cell];
    const float y = brick.y + kernel_.offsets[1][cell];
    const float z = brick.z + kernel_.offsets[2][cell];
    return std::sqrt(x * x + y * y + z * z);
}

}  // namespace octoskin
#endif
