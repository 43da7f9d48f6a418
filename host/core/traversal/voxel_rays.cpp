// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/voxel_rays.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/voxel_rays.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "host/core/traversal/sliding_minimum.hpp"

#ifndef OCTOSKIN_VOXEL_RAYS_TYPES
#define OCTOSKIN_VOXEL_RAYS_TYPES
namespace octoskin {

/// A voxel's centre in the camera's frame.
struct Centre {
    float x, y, z;
};

/// Pixels of an image, both ends inside; empty if a last one is less than its first.
struct SeenPixels {
    int u_first, u_last, v_first, v_last;
};

/// Those whose rays may be in the voxel at its centre's depth. Written without the library's functions, which
/// would be compiled for one instruction set and used by all.
inline SeenPixels seen_pixels(const VoxelRays::Kernel& rays, const Centre& centre) {
    const auto clamped = [](float value, float last) {
        return static_cast<int>(value < 0.0F ? 0.0F : value > last ? last : value);
    };
    const float per_z = 1.0F / centre.z;
    const float u = centre.x * per_z * rays.fx + rays.u_centre;
    const float v = centre.y * per_z * rays.fy + rays.v_centre;
    const float half_u = rays.half_x_m * per_z * rays.fx;
    const float half_v = rays.half_y_m * per_z * rays.fy;
    if (u + half_u < 0.0F || u - half_u > rays.last_u) return {0, -1, 0, -1};
    if (v + half_v < 0.0F || v - half_v > rays.last_v) return {0, -1, 0, -1};
    // Conversion rounds down; what is one pixel too many is found to be outside.
    return {clamped(u - half_u, rays.last_u), clamped(u + half_u + 1.0F, rays.last_u),
            clamped(v - half_v, rays.last_v), clamped(v + half_v + 1.0F, rays.last_v)};
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

template <class Mask>
HWY_INLINE std::uint64_t bits_of(Mask mask) {
    const Tag f;
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(f, mask, bits.data());
    return (bits[0] | static_cast<std::uint64_t>(bits[1]) << 8U) & ((std::uint64_t{1} << hn::Lanes(f)) - 1U);
}

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

/// The pixel nearest to where a coordinate is seen.
HWY_INLINE Lanes rounded_within(Lanes across, Lanes per_z, float focal, float optical_axis, float last) {
    const Tag f;
    const Lanes pixel = hn::Add(hn::Mul(hn::Mul(across, per_z), hn::Set(f, focal)), hn::Set(f, optical_axis));
    // Of a centre beside the picture the nearest is at its edge, and perhaps too far away.
    return hn::Min(hn::Max(hn::Round(pixel), hn::Zero(f)), hn::Set(f, last));
}

/// Whole numbers, a lane each.
struct Pixels {
    Lanes u, v;
};

HWY_INLINE Lanes passed_of(const Kernel& rays, const Pixels& pixels) {
    const Tag f;
    const hn::Rebind<std::int32_t, Tag> i;
    const auto row = hn::Mul(hn::ConvertTo(i, pixels.v), hn::Set(i, static_cast<std::int32_t>(rays.width)));
    return hn::GatherIndex(f, rays.passed_m, hn::Add(row, hn::ConvertTo(i, pixels.u)));
}

/// The furthest that a ray near a pixel goes.
HWY_INLINE Lanes furthest_of(const Kernel& rays, const float* minus_furthest_m, const Pixels& pixels) {
    const Tag f;
    const hn::Rebind<std::int32_t, Tag> i;
    const auto row = hn::Mul(hn::ShiftRight<1>(hn::ConvertTo(i, pixels.v)),
                             hn::Set(i, static_cast<std::int32_t>(rays.blocks_width)));
    const auto column = hn::ShiftRight<1>(hn::ConvertTo(i, pixels.u));
    return hn::Neg(hn::GatherIndex(f, minus_furthest_m, hn::Add(row, column)));
}

/// Some voxels, bit i that of the i-th: those passed by the ray of the pixel nearest to their centre, and
/// those of which all rays must be asked.
struct Passed {
    std::uint64_t certainly = 0;
    std::uint64_t perhaps = 0;
};

HWY_INLINE Passed ask_nearest(const Kernel& rays, const float* minus_furthest_m, Lanes x, Lanes y, Lanes z) {
    const Tag f;
    const auto is_before = hn::Gt(z, hn::Set(f, rays.near_m));
    const Lanes beyond = hn::Add(z, hn::Set(f, rays.margin_m));
    const Lanes per_z = hn::Div(hn::Set(f, 1.0F), hn::Max(z, hn::Set(f, rays.near_m)));
    const Pixels nearest{
        rounded_within(x, per_z, rays.fx, rays.u_centre, rays.last_u),
        rounded_within(y, per_z, rays.fy, rays.v_centre, rays.last_v),
    };
    const auto is_in = is_inside(rays, off_by(nearest.u, rays.u_centre, rays.per_fx, z, x),
                                 off_by(nearest.v, rays.v_centre, rays.per_fy, z, y));
    const auto is_passed = hn::And(hn::And(is_before, is_in), hn::Gt(passed_of(rays, nearest), beyond));
    auto is_open = hn::AndNot(is_passed, is_before);
    if (hn::AllFalse(f, is_open)) return {bits_of(is_passed), 0};
    if (minus_furthest_m != nullptr) {
        is_open = hn::And(is_open, hn::Gt(furthest_of(rays, minus_furthest_m, nearest), beyond));
        if (hn::AllFalse(f, is_open)) return {bits_of(is_passed), 0};
    }
    return {bits_of(is_passed), bits_of(is_open)};
}

/// Calls visit(is in the voxel, pixel of the first lane) for some pixels of a row after the other until it
/// says true.
template <class Visit>
HWY_INLINE bool visit_rays(const Kernel& rays, const Centre& centre, Visit&& visit) {
    const Tag f;
    const SeenPixels seen = seen_pixels(rays, centre);
    const Lanes x = hn::Set(f, centre.x);
    const Lanes y = hn::Set(f, centre.y);
    const Lanes z = hn::Set(f, centre.z);
    for (int v = seen.v_first; v <= seen.v_last; ++v) {
        const Lanes off_y = off_by(hn::Set(f, static_cast<float>(v)), rays.v_centre, rays.per_fy, z, y);
        for (int u = seen.u_first; u <= seen.u_last; u += static_cast<int>(hn::Lanes(f))) {
            const Lanes off_x = off_by(hn::Iota(f, static_cast<float>(u)), rays.u_centre, rays.per_fx, z, x);
            const auto in_row = hn::FirstN(f, static_cast<std::size_t>(seen.u_last + 1 - u));
            const auto is_in = hn::And(in_row, is_inside(rays, off_x, off_y));
            if (visit(is_in, static_cast<std::size_t>(v) * rays.width + static_cast<std::size_t>(u))) {
                return true;
            }
        }
    }
    return false;
}

HWY_INLINE bool is_any_passing(const Kernel& rays, const Centre& centre) {
    const Tag f;
    const Lanes beyond = hn::Set(f, centre.z + rays.margin_m);
    return visit_rays(rays, centre, [&](auto is_in, std::size_t pixel) HWY_ATTR {
        return !hn::AllFalse(f, hn::And(is_in, hn::Gt(hn::LoadU(f, rays.passed_m + pixel), beyond)));
    });
}

/// Whether no ray that any of 64 voxels might see goes as far as they are.
HWY_INLINE bool is_beyond_all(const Kernel& rays, const float* minus_furthest_m, const Centre& middle) {
    if (minus_furthest_m == nullptr || !(middle.z > 4.0F * rays.near_m)) return false;
    const float per_z = 1.0F / middle.z;
    const float u = middle.x * per_z * rays.fx + rays.u_centre + 0.5F;
    const float v = middle.y * per_z * rays.fy + rays.v_centre + 0.5F;
    const auto clamped = [](float value, float last) {
        return static_cast<std::size_t>(value < 0.0F ? 0.0F : value > last ? last : value);
    };
    const std::size_t block =
        (clamped(v, rays.last_v) >> 1U) * rays.blocks_width + (clamped(u, rays.last_u) >> 1U);
    return -minus_furthest_m[block] < middle.z - 4.0F * rays.half_depth_m;
}

/// `minus_furthest_m`: around what a voxel sees; `around_word_m`: around what 4 x 4 x 4 of them see.
void find_passed(const Kernel& rays, const float* minus_furthest_m, const float* around_word_m,
                 const Centre& first, BrickMask& mask) {
    const Tag f;
    const Lanes x = hn::Set(f, first.x);
    const Lanes y = hn::Set(f, first.y);
    const Lanes z = hn::Set(f, first.z);
    std::size_t cell = 0;
    for (std::uint64_t& word : mask) {
        word = 0;
        std::uint64_t open = 0;
        const std::size_t word_cell = cell;
        const auto middle_of = [&](std::size_t axis) {
            return 0.5F * (rays.offsets[axis][word_cell] + rays.offsets[axis][word_cell + 63]);
        };
        if (is_beyond_all(rays, around_word_m,
                          {first.x + middle_of(0), first.y + middle_of(1), first.z + middle_of(2)})) {
            cell += 64;
            continue;
        }
        for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f), cell += hn::Lanes(f)) {
            const Passed passed =
                ask_nearest(rays, minus_furthest_m, hn::Add(x, hn::LoadU(f, rays.offsets[0].data() + cell)),
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
    (void)visit_rays(rays, centre, [&](auto is_in, std::size_t pixel) HWY_ATTR {
        const Lanes reach = hn::LoadU(f, rays.reach_m + pixel);
        const auto is_beyond = hn::Gt(reach, end);
        vote.go_on += static_cast<std::uint32_t>(hn::CountTrue(f, hn::And(is_in, is_beyond)));
        vote.end += static_cast<std::uint32_t>(
            hn::CountTrue(f, hn::And(is_in, hn::AndNot(is_beyond, hn::Ge(reach, begin)))));
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

/// Pixels along each edge of a block.
constexpr std::uint32_t kBlock = 2;

Centre centre_of(const CertainView& view, const VoxelLattice& lattice, VoxelKey key) {
    const Eigen::Vector3f p = (view.T_camera_map * lattice.centre_of(key)).cast<float>();
    return {p.x(), p.y(), p.z()};
}

}  // namespace

void VoxelRays::begin(const CertainView& view, const PlacedImage& image, const VoxelLattice& lattice) {
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
    find_furthest(image);
}

void VoxelRays::find_furthest(const PlacedImage& image) {
    const Raster blocks{(image.width + kBlock - 1) / kBlock, (image.height + kBlock - 1) / kBlock};
    kernel_.blocks_width = blocks.width;
    std::vector<float> least(std::size_t{blocks.width} * blocks.height, 1.0F);
    for (std::uint32_t v = 0; v < image.height; ++v) {
        const float* const row = image.passed_m.data() + std::size_t{v} * image.width;
        float* const out = least.data() + std::size_t{v / kBlock} * blocks.width;
        for (std::uint32_t u = 0; u < image.width; ++u) out[u / kBlock] = std::min(out[u / kBlock], -row[u]);
    }
    constexpr std::array<std::uint32_t, 11> kRadii = {1, 2, 3, 4, 5, 7, 9, 12, 16, 24, 32};
    furthest_.resize(kRadii.size());
    std::uint32_t had = 0;
    for (std::size_t i = 0; i < kRadii.size(); ++i) {
        spread_minimum(least, work_, blocks, had, kRadii[i]);
        had = kRadii[i];
        furthest_[i] = {had, least};
    }
}

const float* VoxelRays::furthest_around(float nearest_m, float voxels) const noexcept {
    if (nearest_m <= 0.0F) return nullptr;
    // Of one voxel its centre's depth is all that counts; several lie at several depths, and so aside of each
    // other's rays.
    const auto apart_px_of = [&](float half_m, float focal, float optical_axis, float last) {
        const float slope_max = std::max(optical_axis, last - optical_axis) / focal;
        const float aside_m = voxels > 1.0F ? slope_max * kernel_.half_depth_m : 0.0F;
        return focal * voxels * (half_m + aside_m) / nearest_m;
    };
    const float apart_px =
        std::max(apart_px_of(kernel_.half_x_m, kernel_.fx, kernel_.u_centre, kernel_.last_u),
                 apart_px_of(kernel_.half_y_m, kernel_.fy, kernel_.v_centre, kernel_.last_v));
    for (const Furthest& furthest : furthest_) {
        // From the nearest pixel, which is half a pixel off, to the last one of the block furthest away.
        if (apart_px + 1.0F <= static_cast<float>(kBlock * furthest.radius_blocks))
            return furthest.minus_passed_m.data();
    }
    return nullptr;
}

BrickMask VoxelRays::passed(VoxelKey lowest) const {
    BrickMask mask;
    const Centre first = centre_of(*view_, *lattice_, lowest);
    const float* const z_offsets = kernel_.offsets[2].data();
    const float nearest_m =
        first.z + std::min({z_offsets[0], z_offsets[73], z_offsets[146], z_offsets[219], z_offsets[292],
                            z_offsets[365], z_offsets[438], z_offsets[511]});
    HWY_DYNAMIC_DISPATCH(find_passed)
    (kernel_, furthest_around(nearest_m, 1.0F), furthest_around(nearest_m, 4.0F), first, mask);
    return mask;
}

RayVote VoxelRays::vote_on(VoxelKey voxel) const {
    RayVote vote;
    const Centre centre = centre_of(*view_, *lattice_, voxel);
    if (centre.z > kernel_.near_m) HWY_DYNAMIC_DISPATCH(count_votes)(kernel_, centre, vote);
    return vote;
}

}  // namespace octoskin
#endif
