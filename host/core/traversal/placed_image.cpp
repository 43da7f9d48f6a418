// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/placed_image.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/placed_image.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_PLACED_IMAGE_TYPES
#define OCTOSKIN_PLACED_IMAGE_TYPES
namespace octoskin {

/// What does not change from pixel to pixel.
struct Placement {
    std::array<std::array<double, 4>, 3> T;  ///< map from camera, row by row
    double voxels_per_m = 0.0;
    float range_max_m = 0.0F;  ///< 0: none
};

/// A row of the image: as many entries as are worked on at once may be read beyond its end.
struct Row {
    const float* depth_m;  ///< NaN beyond the row's end
    const double* ray_x;
    const double* ray_y;
    std::size_t first = 0;  ///< pixel of the image
    std::size_t width = 0;
};

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {

/// One row of `T_map_camera * p`, added up as Eigen does.
HWY_INLINE Float placed(const std::array<double, 4>& row, Double x, Double y, Double z) {
    const Doubles d;
    const Double sum = hn::Add(hn::Add(hn::Mul(hn::Set(d, row[0]), x), hn::Mul(hn::Set(d, row[1]), y)),
                               hn::Mul(hn::Set(d, row[2]), z));
    return hn::DemoteTo(Floats(), hn::Add(sum, hn::Set(d, row[3])));
}

/// Where a coordinate has a key (see `VoxelLattice::key_of`).
HWY_INLINE Mask has_key(Float coordinate, double voxels_per_m) {
    const Doubles d;
    const Double scaled = hn::Mul(hn::Set(d, voxels_per_m), hn::PromoteTo(d, coordinate));
    return hn::And(hn::Ge(scaled, hn::Set(d, -kOriginKey)), hn::Lt(scaled, hn::Set(d, kOriginKey)));
}

/// What is worked out for some pixels at once.
struct Ends {
    Float x, y, z;
    Float reach_m;
    Double range_m;
};

HWY_INLINE auto narrow(Mask mask) {
    const Doubles d;
    const Floats f;
    return hn::Gt(hn::DemoteTo(f, hn::IfThenElseZero(mask, hn::Set(d, 1.0))), hn::Zero(f));
}

/// Rays beyond the maximum range end there, computed as OctoMap does: float but for the square root.
HWY_INLINE void clip(Ends& ends, float range_max_m, const Eigen::Vector3f& origin) {
    const Doubles d;
    const Floats f;
    const Float x = hn::Sub(ends.x, hn::Set(f, origin.x()));
    const Float y = hn::Sub(ends.y, hn::Set(f, origin.y()));
    const Float z = hn::Sub(ends.z, hn::Set(f, origin.z()));
    const Double length = length_of(x, y, z);
    const Mask is_beyond = hn::Gt(length, hn::Set(d, static_cast<double>(range_max_m)));
    const auto is_beyond_f = narrow(is_beyond);
    const Float length_f = hn::DemoteTo(f, length);
    const auto end = [&](Float offset, float from) {
        return hn::Add(hn::Set(f, from), hn::Mul(hn::Div(offset, length_f), hn::Set(f, range_max_m)));
    };
    ends.x = hn::IfThenElse(is_beyond_f, end(x, origin.x()), ends.x);
    ends.y = hn::IfThenElse(is_beyond_f, end(y, origin.y()), ends.y);
    ends.z = hn::IfThenElse(is_beyond_f, end(z, origin.z()), ends.z);
    ends.reach_m = hn::IfThenElse(
        is_beyond_f, hn::Mul(ends.reach_m, hn::Div(hn::Set(f, range_max_m), length_f)), ends.reach_m);
    ends.range_m = hn::IfThenElse(is_beyond, hn::Set(d, -1.0), ends.range_m);
}

void place_row(const Placement& to, const Row& row, PlacedImage& image) {
    const Doubles d;
    const Floats f;
    const Float origin_x = hn::Set(f, image.origin.x());
    const Float origin_y = hn::Set(f, image.origin.y());
    const Float origin_z = hn::Set(f, image.origin.z());
    for (std::size_t u = 0; u < row.width; u += hn::Lanes(d)) {
        const Float depth_m = hn::LoadU(f, row.depth_m + u);
        const Double z = hn::PromoteTo(d, depth_m);
        const Double x = hn::Mul(z, hn::LoadU(d, row.ray_x + u));
        const Double y = hn::Mul(z, hn::LoadU(d, row.ray_y + u));
        Ends ends{placed(to.T[0], x, y, z), placed(to.T[1], x, y, z), placed(to.T[2], x, y, z), depth_m,
                  hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)))};
        if (to.range_max_m > 0.0F) clip(ends, to.range_max_m, image.origin);

        const Mask is_number = hn::Eq(z, z);
        const Mask is_good = hn::And(hn::Gt(z, hn::Zero(d)), hn::Lt(z, hn::Set(d, HUGE_VAL)));
        const Mask has_keys =
            hn::And(has_key(ends.x, to.voxels_per_m),
                    hn::And(has_key(ends.y, to.voxels_per_m), has_key(ends.z, to.voxels_per_m)));
        const Mask is_used = hn::And(is_good, has_keys);
        const Mask in_row = hn::FirstN(d, row.width - u);
        image.counts.used += hn::CountTrue(d, hn::And(in_row, is_used));
        image.counts.no_value += hn::CountTrue(d, hn::AndNot(is_number, in_row));
        image.counts.bad_value += hn::CountTrue(d, hn::AndNot(is_good, hn::And(in_row, is_number)));
        image.counts.outside_map += hn::CountTrue(d, hn::AndNot(has_keys, hn::And(in_row, is_good)));

        const auto is_used_f = narrow(is_used);
        const std::size_t at = row.first + u;
        hn::StoreU(hn::IfThenElse(is_used_f, ends.x, origin_x), f, image.end_x.data() + at);
        hn::StoreU(hn::IfThenElse(is_used_f, ends.y, origin_y), f, image.end_y.data() + at);
        hn::StoreU(hn::IfThenElse(is_used_f, ends.z, origin_z), f, image.end_z.data() + at);
        hn::StoreU(hn::IfThenElse(is_used_f, ends.reach_m, hn::Set(f, -1.0F)), f, image.reach_m.data() + at);
        hn::StoreU(ends.range_m, d, image.range_m.data() + at);
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(place_row);

/// A vector of any instruction set holds no more entries.
constexpr std::size_t kLanesMax = 64;

void resize(PlacedImage& image, std::size_t entries) {
    for (auto* values : {&image.end_x, &image.end_y, &image.end_z, &image.reach_m}) values->resize(entries);
    image.range_m.resize(entries);
}

/// Of the ends, one axis; the origin is among them if any pixel has no ray.
std::pair<float, float> bounds_of(const std::vector<float>& values, float origin) {
    float lowest = origin;
    float highest = origin;
    for (const float value : values) {
        lowest = value < lowest ? value : lowest;
        highest = value > highest ? value : highest;
    }
    return {lowest, highest};
}

}  // namespace

void place_image(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                 const Eigen::Isometry3d& T_map_camera, double range_max_m, PlacedImage& placed) {
    const std::size_t pixels = std::size_t{image.width} * image.height;
    assert(image.width == pixel_rays.camera().width && image.height == pixel_rays.camera().height);
    assert(image.depth_m.size() == pixels);
    placed.width = image.width;
    placed.height = image.height;
    placed.origin = T_map_camera.translation().cast<float>();
    placed.counts = {};
    resize(placed, pixels + kLanesMax);

    Placement to{.T = {},
                 .voxels_per_m = 1.0 / lattice.resolution_m(),
                 .range_max_m = static_cast<float>(range_max_m)};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j)
            to.T[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = T_map_camera(i, j);
    }
    std::vector<float> depth_m(image.width + kLanesMax, std::numeric_limits<float>::quiet_NaN());
    std::vector<double> ray_x(image.width + kLanesMax);
    std::vector<double> ray_y(image.width + kLanesMax);
    for (std::uint32_t v = 0; v < image.height; ++v) {
        const std::size_t first = std::size_t{v} * image.width;
        std::copy_n(image.depth_m.begin() + static_cast<std::ptrdiff_t>(first), image.width, depth_m.begin());
        for (std::uint32_t u = 0; u < image.width; ++u) {
            const RaySlope ray = pixel_rays.at(u, v);
            ray_x[u] = ray.x;
            ray_y[u] = ray.y;
        }
        HWY_DYNAMIC_DISPATCH(place_row)
        (to, {depth_m.data(), ray_x.data(), ray_y.data(), first, image.width}, placed);
    }
    resize(placed, pixels);
    placed.reach_m.resize(pixels + kLanesMax, -1.0F);
    std::fill(placed.reach_m.begin() + static_cast<std::ptrdiff_t>(pixels), placed.reach_m.end(), -1.0F);
    std::tie(placed.lowest.x(), placed.highest.x()) = bounds_of(placed.end_x, placed.origin.x());
    std::tie(placed.lowest.y(), placed.highest.y()) = bounds_of(placed.end_y, placed.origin.y());
    std::tie(placed.lowest.z(), placed.highest.z()) = bounds_of(placed.end_z, placed.origin.z());
}

}  // namespace octoskin
#endif
