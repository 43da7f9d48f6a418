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

#ifndef OCTOSKIN_VOXEL_RAYS_TYPES
#define OCTOSKIN_VOXEL_RAYS_TYPES
namespace octoskin {

/// A voxel's centre in the camera's frame.
struct Centre {
    float x, y, z;
};

/// The furthest that rays in a square of pixels go, by the block in its first corner.
struct SquareOfPixels {
    const float* longest_m = nullptr;  ///< none: the square would be too large
    float half_px = 0.0F;              ///< from its middle on
};

/// Pixels of an image, both ends inside; empty if a last one is less than its first.
struct SeenPixels {
    int u_first, u_last, v_first, v_last;
};

/// Those whose rays are no further than `half_m` from a centre at its depth, along the camera's x and y.
/// Written without the library's functions, which would be compiled for one instruction set and used by all.
inline SeenPixels seen_pixels(const VoxelRays::Kernel& rays, const Centre& centre, float half_m) {
    struct Range {
        int first, last;
    };
    const auto range_of = [](float middle, float half, float last) -> Range {
        const float from = middle - half < 0.0F ? 0.0F : middle - half;
        const float to = middle + half > last ? last : middle + half;
        if (!(from <= to)) return {0, -1};
        const int first = static_cast<int>(from);
        return {static_cast<float>(first) < from ? first + 1 : first, static_cast<int>(to)};
    };
    const float u_per_m = rays.fx / centre.z;
    const float v_per_m = rays.fy / centre.z;
    const Range u = range_of(centre.x * u_per_m + rays.u_centre, half_m * u_per_m, rays.last_u);
    const Range v = range_of(centre.y * v_per_m + rays.v_centre, half_m * v_per_m, rays.last_v);
    return {u.first, u.last, v.first, v.last};
}

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Kernel = VoxelRays::Kernel;

// Sixteen at most: the bits of a mask then fit two bytes.
using Tag = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Tag>;

// One for each word of a BrickMask, or a part of them.
using WordTag = hn::CappedTag<float, 8>;
using WordInts = hn::RebindToSigned<WordTag>;
using Words = hn::Vec<WordTag>;

/// Where a ray that is `off` the centre at its depth is in the voxel there.
HWY_INLINE auto is_inside(const Kernel& rays, Lanes off_x, Lanes off_y) {
    const Tag f;
    Lanes furthest = hn::Zero(f);
    for (const auto& axis : rays.across) {
        const Lanes along = hn::Add(hn::Mul(off_x, hn::Set(f, axis[0])), hn::Mul(off_y, hn::Set(f, axis[1])));
        furthest = hn::Max(furthest, hn::Abs(along));
    }
    return hn::Lt(furthest, hn::Set(f, rays.inside_m));
}

/// How far the ray of a pixel is from a centre at its depth, along the camera's x or y.
HWY_INLINE Lanes off_by(Lanes pixel, float optical_axis, float per_focal, Lanes z, Lanes centre) {
    const Tag f;
    const Lanes slope = hn::Mul(hn::Sub(pixel, hn::Set(f, optical_axis)), hn::Set(f, per_focal));
    return hn::Sub(hn::Mul(slope, z), centre);
}

/// Columns and rows, a lane each.
struct Pixels {
    Lanes u, v;
};

HWY_INLINE Lanes within(Lanes pixel, float last) {
    const Tag f;
    return hn::Min(hn::Max(pixel, hn::Zero(f)), hn::Set(f, last));
}

/// Of each in a raster: pixels, or blocks of 2^shift pixels.
template <int kShift>
HWY_INLINE Lanes looked_up(const float* values, std::uint32_t columns, const Pixels& pixels) {
    const hn::Rebind<std::int32_t, Tag> i;
    const auto row = hn::Mul(hn::ShiftRight<kShift>(hn::ConvertTo(i, pixels.v)),
                             hn::Set(i, static_cast<std::int32_t>(columns)));
    return hn::GatherIndex(Tag(), values, hn::Add(row, hn::ShiftRight<kShift>(hn::ConvertTo(i, pixels.u))));
}

/// Some voxels, bit i that of the i-th: those passed by the ray of the pixel nearest to their centre, and
/// those of which all rays must be asked.
struct Passed {
    std::uint64_t certainly = 0;
    std::uint64_t perhaps = 0;
};

HWY_INLINE Passed ask_nearest(const Kernel& rays, const SquareOfPixels& square, Lanes x, Lanes y, Lanes z) {
    const Tag f;
    const auto is_before = hn::Gt(z, hn::Set(f, rays.near_m));
    const Lanes beyond = hn::Add(z, hn::Set(f, rays.margin_m));
    const Lanes per_z = hn::Div(hn::Set(f, 1.0F), hn::Max(z, hn::Set(f, rays.near_m)));
    const auto seen_at = [&](Lanes across, float focal, float optical_axis) HWY_ATTR {
        return hn::Add(hn::Mul(hn::Mul(across, per_z), hn::Set(f, focal)), hn::Set(f, optical_axis));
    };
    const Pixels centre{seen_at(x, rays.fx, rays.u_centre), seen_at(y, rays.fy, rays.v_centre)};
    // Of a centre beside the picture the nearest is at its edge, and perhaps too far away.
    const Pixels nearest{within(hn::Round(centre.u), rays.last_u), within(hn::Round(centre.v), rays.last_v)};
    const auto is_in = is_inside(rays, off_by(nearest.u, rays.u_centre, rays.per_fx, z, x),
                                 off_by(nearest.v, rays.v_centre, rays.per_fy, z, y));
    const auto is_passed =
        hn::And(hn::And(is_before, is_in), hn::Gt(looked_up<0>(rays.passed_m, rays.width, nearest), beyond));
    auto is_open = hn::AndNot(is_passed, is_before);
    if (hn::AllFalse(f, is_open)) return {bits_of(f, is_passed), 0};
    if (square.longest_m != nullptr) {
        const Lanes half = hn::Set(f, square.half_px);
        const Pixels first{within(hn::Sub(centre.u, half), rays.last_u),
                           within(hn::Sub(centre.v, half), rays.last_v)};
        is_open = hn::And(is_open, hn::Gt(looked_up<1>(square.longest_m, rays.blocks_width, first), beyond));
    }
    return {bits_of(f, is_passed), bits_of(f, is_open)};
}

/// Calls visit(which of the lanes, first column, row) for some pixels of a row after the other until it says
/// true.
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

HWY_INLINE Lanes loaded(const Kernel& rays, const float* values, int u, int v) {
    return hn::LoadU(Tag(), values + static_cast<std::size_t>(v) * rays.width + static_cast<std::size_t>(u));
}

HWY_INLINE bool is_any_passing(const Kernel& rays, const Centre& centre) {
    const Tag f;
    const Lanes beyond = hn::Set(f, centre.z + rays.margin_m);
    return visit_pixels(seen_pixels(rays, centre, rays.near_centre_m), [&](auto in_row, int u,
                                                                           int v) HWY_ATTR {
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

/// Of the eight words of a brick, a bit each: those of which every voxel is passed, and those of which none
/// is.
struct WordVerdicts {
    std::uint32_t all = 0;
    std::uint32_t none = 0;
};

/// First and last pixel, of a row or a column, whose rays may be in one of 64 voxels at its centre's depth.
struct Seen {
    Words first, last;
};

HWY_INLINE Seen seen_of(Words middle, float half_m, Words per_nearest, Words per_furthest, float focal,
                        float optical_axis) {
    const WordTag f;
    // A voxel's centre is up to three halves of an edge from the middle, its side a half further.
    const Words reach = hn::Set(f, 4.0F * half_m);
    const Words low = hn::Sub(middle, reach);
    const Words high = hn::Add(middle, reach);
    const auto pixel = [&](Words slope) {
        return hn::Add(hn::Mul(slope, hn::Set(f, focal)), hn::Set(f, optical_axis));
    };
    constexpr float kRounding_px = 0.01F;
    return {hn::Sub(pixel(hn::Min(hn::Mul(low, per_nearest), hn::Mul(low, per_furthest))),
                    hn::Set(f, kRounding_px)),
            hn::Add(pixel(hn::Max(hn::Mul(high, per_nearest), hn::Mul(high, per_furthest))),
                    hn::Set(f, kRounding_px))};
}

HWY_INLINE auto block_of(Words pixel, float last) {
    const WordTag f;
    static_assert(ReachWindows::kBlock == 2);
    const Words inside = hn::Min(hn::Max(pixel, hn::Zero(f)), hn::Set(f, last));
    return hn::ShiftRight<1>(hn::ConvertTo(WordInts(), inside));
}

/// What can be said of the words without looking at any voxel. `first`: the centre of the brick's first.
HWY_INLINE WordVerdicts judge_words(const Kernel& rays, const Centre& first) {
    const WordTag f;
    const WordInts i;
    WordVerdicts verdicts;
    for (std::size_t word = 0; word < 8; word += hn::Lanes(f)) {
        const Words x = hn::Add(hn::Set(f, first.x), hn::LoadU(f, rays.middles[0].data() + word));
        const Words y = hn::Add(hn::Set(f, first.y), hn::LoadU(f, rays.middles[1].data() + word));
        const Words z = hn::Add(hn::Set(f, first.z), hn::LoadU(f, rays.middles[2].data() + word));
        const Words half_depth = hn::Set(f, 3.0F * rays.half_depth_m);  // of the voxels' centres
        const Words nearest = hn::Sub(z, half_depth);
        const Words furthest = hn::Add(z, half_depth);
        const Words near = hn::Set(f, rays.near_m);
        const auto is_before = hn::Gt(nearest, near);
        const Words per_nearest = hn::Div(hn::Set(f, 1.0F), hn::Max(nearest, near));
        const Words per_furthest = hn::Div(hn::Set(f, 1.0F), hn::Max(furthest, near));
        const Seen u = seen_of(x, rays.half_x_m, per_nearest, per_furthest, rays.fx, rays.u_centre);
        const Seen v = seen_of(y, rays.half_y_m, per_nearest, per_furthest, rays.fy, rays.v_centre);
        const Words zero = hn::Zero(f);
        const Words last_u = hn::Set(f, rays.last_u);
        const Words last_v = hn::Set(f, rays.last_v);
        const auto is_beside = hn::Or(hn::Or(hn::Lt(u.last, zero), hn::Gt(u.first, last_u)),
                                      hn::Or(hn::Lt(v.last, zero), hn::Gt(v.first, last_v)));
        const auto is_whole = hn::And(hn::And(hn::Ge(u.first, zero), hn::Le(u.last, last_u)),
                                      hn::And(hn::Ge(v.first, zero), hn::Le(v.last, last_v)));

        const auto u_first = block_of(u.first, rays.last_u);
        const auto u_last = block_of(u.last, rays.last_u);
        const auto v_first = block_of(v.first, rays.last_v);
        const auto v_last = block_of(v.last, rays.last_v);
        // Two windows cover what is twice as long.
        const auto size = hn::Max(hn::Sub(u_last, u_first), hn::Sub(v_last, v_first));
        const auto size_max = static_cast<std::uint32_t>(hn::GetLane(hn::MaxOfLanes(i, size))) + 1;
        const std::uint32_t level =
            size_max < 3 ? 0 : 31U - static_cast<std::uint32_t>(__builtin_clz(size_max - 1));
        if (level >= ReachWindows::kLevels) {
            verdicts.none |= static_cast<std::uint32_t>(bits_of(f, hn::And(is_before, is_beside)) << word);
            continue;
        }
        const auto edge = hn::Set(i, 1 << level);
        const auto u_second = hn::Max(hn::Sub(hn::Add(u_last, hn::Set(i, 1)), edge), hn::Zero(i));
        const auto v_second = hn::Max(hn::Sub(hn::Add(v_last, hn::Set(i, 1)), edge), hn::Zero(i));
        const auto width = hn::Set(i, static_cast<std::int32_t>(rays.blocks_width));
        const auto row_first = hn::Mul(v_first, width);
        const auto row_second = hn::Mul(v_second, width);
        const auto at = {hn::Add(row_first, u_first), hn::Add(row_first, u_second),
                         hn::Add(row_second, u_first), hn::Add(row_second, u_second)};
        Words shortest = hn::Set(f, 1e30F);
        Words longest = hn::Set(f, -1.0F);
        for (const auto& block : at) {
            shortest = hn::Min(shortest, hn::GatherIndex(f, rays.shortest_m[level], block));
            longest = hn::Max(longest, hn::GatherIndex(f, rays.longest_m[level], block));
        }
        const auto is_beyond = hn::Or(is_beside, hn::Le(longest, nearest));
        const auto is_seen = hn::And(is_whole, hn::Le(furthest, hn::Set(f, rays.depth_max_m)));
        const auto is_passed =
            hn::And(is_seen, hn::Gt(shortest, hn::Add(furthest, hn::Set(f, rays.margin_m))));
        verdicts.none |= static_cast<std::uint32_t>(bits_of(f, hn::And(is_before, is_beyond)) << word);
        verdicts.all |= static_cast<std::uint32_t>(bits_of(f, hn::And(is_before, is_passed)) << word);
    }
    return verdicts;
}

void find_passed(const Kernel& rays, const SquareOfPixels& square, const Centre& first, BrickMask& mask) {
    const Tag f;
    const Lanes x = hn::Set(f, first.x);
    const Lanes y = hn::Set(f, first.y);
    const Lanes z = hn::Set(f, first.z);
    const WordVerdicts verdicts = judge_words(rays, first);
    for (std::size_t number = 0; number < mask.size(); ++number) {
        std::uint64_t& word = mask[number];
        const bool is_all = (verdicts.all >> number & 1U) != 0;
        word = is_all ? ~std::uint64_t{0} : 0;
        if (is_all || (verdicts.none >> number & 1U) != 0) continue;
        std::uint64_t open = 0;
        const std::size_t word_cell = 64 * number;
        std::size_t cell = word_cell;
        for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f), cell += hn::Lanes(f)) {
            const Passed passed =
                ask_nearest(rays, square, hn::Add(x, hn::LoadU(f, rays.offsets[0].data() + cell)),
                            hn::Add(y, hn::LoadU(f, rays.offsets[1].data() + cell)),
                            hn::Add(z, hn::LoadU(f, rays.offsets[2].data() + cell)));
            word |= passed.certainly << bit;
            open |= passed.perhaps << bit;
        }
        for (; open != 0; open &= open - 1) {
            const auto bit = static_cast<unsigned>(__builtin_ctzll(open));
            const std::size_t at = word_cell + bit;
            const Centre centre{first.x + rays.offsets[0][at], first.y + rays.offsets[1][at],
                                first.z + rays.offsets[2][at]};
            if (is_any_passing(rays, centre)) word |= std::uint64_t{1} << bit;
        }
    }
}

void count_votes(const Kernel& rays, const Centre& centre, RayVote& vote) {
    const Tag f;
    const Lanes begin = hn::Set(f, centre.z - rays.half_depth_m);
    const Lanes end = hn::Set(f, centre.z + rays.end_m);
    (void)visit_pixels(seen_pixels(rays, centre, rays.half_edge_m), [&](auto in_row, int u, int v) HWY_ATTR {
        const Lanes reach = loaded(rays, rays.reach_m, u, v);
        const auto is_beyond = hn::Gt(reach, end);
        vote.go_on += static_cast<std::uint32_t>(hn::CountTrue(f, hn::And(in_row, is_beyond)));
        vote.end += static_cast<std::uint32_t>(
            hn::CountTrue(f, hn::And(in_row, hn::AndNot(is_beyond, hn::Ge(reach, begin)))));
        return false;
    });
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_passed);
HWY_EXPORT(count_votes);

/// In edges. A filtered depth of 3 cm of noise is still 0.6 cm off: were it 0.5, a surface just behind a
/// voxel would mark it now and then; at 0 one in the voxel's farther half is not seen (docs/results.md).
constexpr double kEndsBehindCentre = 0.2;

/// In edges. Rays nearer to a voxel's corners graze what is beside it: they would free surfaces
/// (docs/results.md).
constexpr double kNearCentre = 0.45;

/// Which holds the pixels of each voxel's rays from `nearest_m` on.
SquareOfPixels square_from(const VoxelRays::Kernel& rays, float nearest_m) {
    if (!(nearest_m > 0.0F)) return {};
    const float half_px = std::max(rays.fx, rays.fy) * rays.near_centre_m / nearest_m + 0.01F;
    // As many blocks as they may begin and end in.
    const float blocks = half_px + 2.0F;
    for (std::uint32_t k = 0; k < ReachWindows::kLevels; ++k) {
        if (blocks < static_cast<float>((1U << k) + 1)) return {rays.longest_m[k], half_px};
    }
    return {};
}

}  // namespace

void VoxelRays::begin(const CertainView& view, const PlacedImage& image, const ReachWindows& reach,
                      const VoxelLattice& lattice) {
    view_ = &view;
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
    kernel_.half_x_m = static_cast<float>(0.5 * view.resolution_m * R_camera_map.row(0).lpNorm<1>());
    kernel_.half_y_m = static_cast<float>(0.5 * view.resolution_m * R_camera_map.row(1).lpNorm<1>());
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
    for (std::uint32_t k = 0; k < ReachWindows::kLevels; ++k) {
        kernel_.shortest_m[k] = reach.level(k).shortest.data();
        kernel_.longest_m[k] = reach.level(k).longest.data();
    }
}

VoxelRays::Brick VoxelRays::brick_at(VoxelKey lowest) const {
    const Eigen::Vector3f p = (view_->T_camera_map * lattice_->centre_of(lowest)).cast<float>();
    return {p.x(), p.y(), p.z()};
}

BrickMask VoxelRays::passed(const Brick& brick) const {
    BrickMask mask;
    const float* const z_offsets = kernel_.offsets[2].data();
    const float nearest_m =
        brick.z + std::min({z_offsets[0], z_offsets[73], z_offsets[146], z_offsets[219], z_offsets[292],
                            z_offsets[365], z_offsets[438], z_offsets[511]});
    HWY_DYNAMIC_DISPATCH(find_passed)
    (kernel_, square_from(kernel_, nearest_m), {brick.x, brick.y, brick.z}, mask);
    return mask;
}

RayVote VoxelRays::vote_on(const Brick& brick, std::size_t cell) const {
    RayVote vote;
    const Centre centre{brick.x + kernel_.offsets[0][cell], brick.y + kernel_.offsets[1][cell],
                        brick.z + kernel_.offsets[2][cell]};
    if (centre.z > kernel_.near_m) HWY_DYNAMIC_DISPATCH(count_votes)(kernel_, centre, vote);
    return vote;
}

}  // namespace octoskin
#endif
