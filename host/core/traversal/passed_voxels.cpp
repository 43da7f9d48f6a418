// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/passed_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/passed_voxels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/core/traversal/lanes-inl.hpp"
#include "host/core/traversal/open_voxel-inl.hpp"
#include "host/core/traversal/voxel_pixels-inl.hpp"
#include "host/core/traversal/word_coverage-inl.hpp"

#ifndef OCTOSKIN_PASSED_VOXELS_TYPES
#define OCTOSKIN_PASSED_VOXELS_TYPES
namespace octoskin {

/// A brick, by its first voxel.
struct AskedBrick {
    Centre camera;    ///< that voxel's centre in the camera's frame
    AlongAxes map{};  ///< its centre, from the camera, along the map's axes
    VoxelKey lowest;  ///< its key
    SquareOfPixels square;
};

/// The coordinates of each cell in its brick.
inline constexpr std::array<std::array<std::uint8_t, 3>, kBrickVoxels> kPlaces = [] {
    std::array<std::array<std::uint8_t, 3>, kBrickVoxels> places{};
    for (unsigned cell = 0; cell < kBrickVoxels; ++cell) {
        for (unsigned axis = 0; axis < 3; ++axis)
            places[cell][axis] = static_cast<std::uint8_t>((cell >> axis & 1U) | (cell >> (axis + 2) & 2U) |
                                                           (cell >> (axis + 4) & 4U));
    }
    return places;
}();

/// Numbers of voxels along each axis, in VoxelNumbers: a key of -1 or of one too many has a number, too.
inline constexpr std::array<double, 3> kNumberStrides = {1.0, 131072.0, 17179869184.0};

inline double number_of(int x, int y, int z) {
    return (x + 1) * kNumberStrides[0] + (y + 1) * kNumberStrides[1] + (z + 1) * kNumberStrides[2];
}

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// How far from its centre's image, in pixels, a slightly enlarged voxel may be seen.
HWY_INLINE Pixels half_images(const Exact& exact, const Centres& centres, Lanes nearest) {
    const Tag f;
    const VoxelRays::Kernel& pixels = exact.pixels;
    const Lanes per_z = hn::Div(hn::Set(f, 1.0F), hn::Max(centres.z, hn::Set(f, pixels.near_m)));
    const Lanes half =
        hn::Div(hn::Set(f, exact.half_larger_m), hn::Max(nearest, hn::Set(f, exact.half_depth_m)));
    const auto seen_by = [&](Lanes across, const AlongAxes& axes, float focal) HWY_ATTR {
        const Lanes slope = hn::Mul(across, per_z);
        Lanes apart = hn::Zero(f);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Lanes off = hn::Sub(hn::Set(f, axes[axis]), hn::Mul(slope, hn::Set(f, exact.axes_z[axis])));
            apart = hn::Add(apart, hn::Abs(off));
        }
        constexpr float kRounding_px = 0.01F;
        return hn::Add(hn::Mul(hn::Mul(half, apart), hn::Set(f, focal)), hn::Set(f, kRounding_px));
    };
    return {seen_by(centres.x, exact.axes_x, pixels.fx), seen_by(centres.y, exact.axes_y, pixels.fy)};
}

/// Returns the voxels of a word that a ray possibly reaches, and stores the pixels of each.
HWY_INLINE std::uint64_t ask_reach(const Exact& exact, const AskedBrick& brick, std::size_t word_cell,
                                   NearPixels& near_pixels) {
    const Tag f;
    const VoxelRays::Kernel& pixels = exact.pixels;
    const bool has_square = brick.square.longest_m != nullptr;
    const Lanes square = hn::Set(f, brick.square.half_px);
    WordLookUps longest_m;
    std::uint64_t is_near = 0;
    std::uint64_t is_in_picture = 0;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
        const Centres centres = centres_of(pixels, brick.camera, word_cell + bit);
        const Pixels centre = pixels_at(pixels, centres);
        const Lanes nearest = hn::Sub(centres.z, hn::Set(f, exact.half_depth_m));
        const Pixels half = half_images(exact, centres, nearest);
        near_pixels.put(bit, pixels, centre, half);
        const auto meets = [&](Lanes at, Lanes by, float last) HWY_ATTR {
            return hn::And(hn::Ge(hn::Add(at, by), hn::Zero(f)), hn::Le(hn::Sub(at, by), hn::Set(f, last)));
        };
        is_in_picture |= bits_of(f, hn::And(meets(centre.u, half.u, pixels.last_u),
                                            meets(centre.v, half.v, pixels.last_v)))
                         << bit;
        const auto is_before = hn::Gt(centres.z, hn::Set(f, -exact.half_depth_m));
        is_near |= bits_of(f, hn::And(is_before, hn::Lt(nearest, hn::Set(f, exact.half_depth_m)))) << bit;
        longest_m.put(bit,
                      places_of<1>(pixels.blocks_width, {within(hn::Sub(centre.u, square), pixels.last_u),
                                                         within(hn::Sub(centre.v, square), pixels.last_v)}));
    }
    if (!has_square) return is_near | is_in_picture;
    longest_m.look_up(brick.square.longest_m);
    std::uint64_t is_reached = 0;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
        const Lanes z = centres_of(pixels, brick.camera, word_cell + bit).z;
        const Lanes nearest = hn::Sub(z, hn::Set(f, exact.half_depth_m));
        is_reached |= bits_of(f, hn::Ge(longest_m.values(bit), nearest)) << bit;
    }
    return is_near | (is_in_picture & is_reached);
}

HWY_INLINE AskedVoxel voxel_of(const Exact& exact, const AskedBrick& brick, std::size_t cell) {
    const std::array<std::uint8_t, 3>& at = kPlaces[cell];
    const std::array<int, 3> key = {brick.lowest.x + at[0], brick.lowest.y + at[1], brick.lowest.z + at[2]};
    AskedVoxel voxel;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        voxel.centre[axis] = brick.map[axis] + exact.offsets[axis][cell];
        const int away = key[axis] - exact.origin_key[axis];
        voxel.side[axis] = away > 0 ? 1.0F : away < 0 ? -1.0F : 0.0F;
    }
    const float z = brick.camera.z + exact.pixels.offsets[2][cell];
    voxel.nearest_m = z - exact.half_depth_m;
    voxel.furthest_m = z + exact.half_depth_m;
    voxel.number = number_of(key[0], key[1], key[2]);
    return voxel;
}

/// False for a voxel that is completely outside the image.
bool is_in_sight(const Exact& exact, const AskedBrick& brick, std::size_t cell) {
    const auto& offsets = exact.pixels.offsets;
    const float x = brick.camera.x + offsets[0][cell];
    const float y = brick.camera.y + offsets[1][cell];
    const float z = brick.camera.z + offsets[2][cell];
    return std::ranges::all_of(exact.borders, [&](const auto& border) {
        return x * border[0] + y * border[1] + z * border[2] >= -border[3];
    });
}

/// Tests all rays of an open voxel.
bool is_open_voxel_passed(const Exact& exact, const AskedBrick& brick, std::size_t cell,
                          const SeenPixels& seen) {
    const float nearest_m = brick.camera.z + exact.pixels.offsets[2][cell] - exact.half_depth_m;
    if (nearest_m >= exact.half_depth_m) {
        if (!is_large(seen) && !is_reached(exact.pixels, nearest_m, seen)) return false;
        return is_passed(exact, voxel_of(exact, brick, cell), seen);
    }
    if (!is_in_sight(exact, brick, cell)) return false;
    const SeenPixels all{0, static_cast<int>(exact.pixels.width) - 1, 0,
                         static_cast<int>(exact.pixels.height) - 1};
    return is_passed(exact, voxel_of(exact, brick, cell), all);
}

/// Implements PassedVoxels::of().
void find_all_passed(const Exact& exact, const AskedBrick& brick, const BrickMask& ends, BrickMask& mask) {
    const WordCoverage verdicts = judge_words(exact.pixels, brick.camera);
    for (std::size_t number = 0; number < mask.size(); ++number) {
        std::uint64_t& word = mask[number];
        const bool is_all = (verdicts.all >> number & 1U) != 0;
        word = is_all ? ~ends[number] : 0;
        if (is_all || (verdicts.none >> number & 1U) != 0) continue;
        const std::size_t word_cell = 64 * number;
        word = ask_nearest(exact.pixels, brick.camera, word_cell).certainly & ~ends[number];
        std::uint64_t open = ~word & ~ends[number];
        if (open == 0) continue;
        NearPixels near_pixels;
        open &= ask_reach(exact, brick, word_cell, near_pixels);
        for (; open != 0; open &= open - 1) {
            const auto bit = static_cast<unsigned>(__builtin_ctzll(open));
            if (is_open_voxel_passed(exact, brick, word_cell + bit, near_pixels.of(bit)))
                word |= std::uint64_t{1} << bit;
        }
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_all_passed);

AlongAxes along_axes(const Eigen::Vector3d& p) {
    return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

/// See BrickVisibility.
void set_borders(const CertainView& view, PassedVoxels::Kernel& kernel) {
    const CameraIntrinsics& camera = view.camera;
    const std::array<Eigen::Vector3d, 4> normals = {
        Eigen::Vector3d(1.0, 0.0, camera.cx / camera.fx),
        Eigen::Vector3d(-1.0, 0.0, (camera.width - camera.cx) / camera.fx),
        Eigen::Vector3d(0.0, 1.0, camera.cy / camera.fy),
        Eigen::Vector3d(0.0, -1.0, (camera.height - camera.cy) / camera.fy)};
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const Eigen::Vector3d normal_map = view.T_camera_map.linear().transpose() * normals[i];
        const AlongAxes normal = along_axes(normals[i]);
        const double inside_m =
            0.5 * view.resolution_m * normal_map.lpNorm<1>() + view.margin_m * normals[i].lpNorm<1>();
        kernel.borders[i] = {normal[0], normal[1], normal[2], static_cast<float>(inside_m)};
    }
}

void set_directions(const CertainView& view, PassedVoxels::Kernel& kernel) {
    const CameraIntrinsics& camera = view.camera;
    const Eigen::Matrix3d R_camera_map = view.T_camera_map.linear();
    const Eigen::Vector3d corner((0.5 - camera.cx) / camera.fx, (0.5 - camera.cy) / camera.fy, 1.0);
    kernel.first = along_axes(R_camera_map.transpose() * corner);
    kernel.next_u = along_axes(R_camera_map.row(0).transpose() / camera.fx);
    kernel.next_v = along_axes(R_camera_map.row(1).transpose() / camera.fy);
    kernel.axes_x = along_axes(R_camera_map.row(0).transpose());
    kernel.axes_y = along_axes(R_camera_map.row(1).transpose());
    kernel.axes_z = along_axes(R_camera_map.row(2).transpose());
}

}  // namespace

void PassedVoxels::begin(const CertainView& view, const ProjectedImage& image, const BrickVisibility& picture,
                         const RangePyramid& reach, const VoxelLattice& lattice, const KeyBox& box) {
    assert(view.depth_max_m > 0.0 && image.end_x.size() >= image.pixels());
    view_ = &view;
    picture_ = &picture;
    lattice_ = &lattice;
    origin_ = image.origin.cast<double>();
    rays_.begin(view, image, reach, lattice);
    kernel_.pixels = rays_.kernel();
    const auto margin_m = static_cast<float>(view.margin_m);
    kernel_.half_depth_m = static_cast<float>(view.half_depth_m) + margin_m;
    // A ray passes a voxel at any of its depths, not only that of its centre.
    kernel_.pixels.word_x_m += margin_m;
    kernel_.pixels.word_y_m += margin_m;
    kernel_.pixels.word_depth_m += kernel_.half_depth_m;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            kernel_.offsets[axis][cell] = static_cast<float>(kPlaces[cell][axis] * view.resolution_m);
    }
    kernel_.half_smaller_m = static_cast<float>(0.5 * view.resolution_m - view.margin_m);
    kernel_.half_larger_m = static_cast<float>(0.5 * view.resolution_m + view.margin_m);
    set_borders(view, kernel_);
    set_directions(view, kernel_);
    const VoxelKey origin = *lattice.key_of(origin_);
    kernel_.origin_key = {origin.x, origin.y, origin.z};
    // Rounding may lead a ray one voxel out of the box.
    const double faces_max =
        box.highest.x - box.lowest.x + box.highest.y - box.lowest.y + box.highest.z - box.lowest.z + 9.0;
    kernel_.walk =
        walk_of(image, lattice, {number_of(origin.x, origin.y, origin.z), kNumberStrides}, faces_max);
}

BrickMask PassedVoxels::of(MortonCode brick, const BrickMask& ends) const {
    const VoxelKey lowest = key_of_morton(brick);
    const Eigen::Vector3d first = lattice_->centre_of(lowest);
    const Eigen::Vector3d first_camera = view_->T_camera_map * first;
    const Eigen::Vector3d to_middle = Eigen::Vector3d::Constant(0.5 * (kBrickEdge - 1) * view_->resolution_m);
    const Eigen::Vector3f p = first_camera.cast<float>();
    const Eigen::Vector3d middle = first_camera + view_->T_camera_map.linear() * to_middle;
    const AskedBrick asked{{p.x(), p.y(), p.z()},
                           along_axes(first - origin_),
                           lowest,
                           picture_->square_of_voxels(middle, kBrickEdge)};
    BrickMask mask;
    HWY_DYNAMIC_DISPATCH(find_all_passed)(kernel_, asked, ends, mask);
    return mask;
}

}  // namespace octoskin
#endif
