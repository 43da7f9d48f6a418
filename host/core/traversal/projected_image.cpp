// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/projected_image.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/projected_image.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "host/core/traversal/image_bands.hpp"
#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_PLACED_IMAGE_TYPES
#define OCTOSKIN_PLACED_IMAGE_TYPES
namespace octoskin {

/// Values that are the same for all pixels.
struct Placement {
    std::array<std::array<double, 4>, 3> T;  ///< map from camera, row by row
    double voxels_per_m = 0.0;
    float range_max_m = 0.0F;   ///< 0: none
    float half_depth_m = 0.0F;  ///< of a voxel, along the optical axis
};

/// A row of the image. Up to one vector may be read beyond its end.
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

/// One row of `T_map_camera * p`, with the additions in Eigen's order.
HWY_INLINE Float placed(const std::array<double, 4>& row, Double x, Double y, Double z) {
    const Doubles d;
    const Double sum = hn::Add(hn::Add(hn::Mul(hn::Set(d, row[0]), x), hn::Mul(hn::Set(d, row[1]), y)),
                               hn::Mul(hn::Set(d, row[2]), z));
    return hn::DemoteTo(Floats(), hn::Add(sum, hn::Set(d, row[3])));
}

/// A coordinate in voxels.
HWY_INLINE Double scaled_by(double voxels_per_m, Float coordinate) {
    const Doubles d;
    return hn::Mul(hn::Set(d, voxels_per_m), hn::PromoteTo(d, coordinate));
}

/// True where a coordinate has a key (see `VoxelLattice::key_of`).
HWY_INLINE Mask has_key(Double scaled) {
    const Doubles d;
    return hn::And(hn::Ge(scaled, hn::Set(d, -kOriginKey)), hn::Lt(scaled, hn::Set(d, kOriginKey)));
}
/// Any value where there is no key: the conversion of a NaN depends on the processor.
HWY_INLINE auto key_of(Double scaled, Mask has_key) {
    const Ints i;
    const Double floored = hn::Floor(hn::IfThenElseZero(has_key, scaled));
    return hn::Add(hn::DemoteTo(i, floored), hn::Set(i, kOriginKey));
}

HWY_INLINE Mask is_at_face(Double scaled) {
    const Doubles d;
    const Double from_face = hn::Abs(hn::Sub(scaled, hn::Round(scaled)));
    const Double margin = hn::Add(hn::Set(d, kAtFace), hn::Mul(hn::Set(d, kAtFaceShare), hn::Abs(scaled)));
    return hn::Lt(from_face, margin);
}

/// Results for one vector of pixels.
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

/// Rays beyond the maximum range end at it, computed as in OctoMap: float except for the square root.
HWY_INLINE void clip(Ends& ends, float range_max_m, const Eigen::Vector3f& origin) {
    const Doubles d;
    const Floats f;
    const Float x = hn::Sub(ends.x, hn::Set(f, origin.x()));
    const Float y = hn::Sub(ends.y, hn::Set(f, origin.y()));
    const Float z = hn::Sub(ends.z, hn::Set(f, origin.z()));
    const double max_m = static_cast<double>(range_max_m);
    const Double squared = hn::PromoteTo(d, squared_length_of(x, y, z));
    // Most ends are clearly nearer, and a square root is slow. The exact test follows.
    if (hn::AllFalse(d, hn::Gt(squared, hn::Set(d, max_m * max_m * (1.0 - 1e-9))))) return;
    const Double length = hn::Sqrt(squared);
    const Mask is_beyond = hn::Gt(length, hn::Set(d, max_m));
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

void place_row(const Placement& to, const Row& row, ProjectedImage& image, RowSums& sums) {
    const Doubles d;
    const Floats f;
    const Float origin_x = hn::Set(f, image.origin.x());
    const Float origin_y = hn::Set(f, image.origin.y());
    const Float origin_z = hn::Set(f, image.origin.z());
    Float lowest_x = origin_x, lowest_y = origin_y, lowest_z = origin_z;
    Float highest_x = origin_x, highest_y = origin_y, highest_z = origin_z;
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
        const Double scaled_x = scaled_by(to.voxels_per_m, ends.x);
        const Double scaled_y = scaled_by(to.voxels_per_m, ends.y);
        const Double scaled_z = scaled_by(to.voxels_per_m, ends.z);
        const Mask has_keys = hn::And(has_key(scaled_x), hn::And(has_key(scaled_y), has_key(scaled_z)));
        const Mask is_used = hn::And(is_good, has_keys);
        const Mask in_row = hn::FirstN(d, row.width - u);
        const std::size_t used = hn::CountTrue(d, hn::And(in_row, is_used));
        sums.counts.used += used;
        if (used < hn::Lanes(d)) {
            sums.counts.no_value += hn::CountTrue(d, hn::AndNot(is_number, in_row));
            sums.counts.bad_value += hn::CountTrue(d, hn::AndNot(is_good, hn::And(in_row, is_number)));
            sums.counts.outside_map += hn::CountTrue(d, hn::AndNot(has_keys, hn::And(in_row, is_good)));
        }

        const auto is_used_f = narrow(is_used);
        const std::size_t at = row.first + u;
        ends.x = hn::IfThenElse(is_used_f, ends.x, origin_x);
        ends.y = hn::IfThenElse(is_used_f, ends.y, origin_y);
        ends.z = hn::IfThenElse(is_used_f, ends.z, origin_z);
        lowest_x = hn::Min(lowest_x, ends.x);
        lowest_y = hn::Min(lowest_y, ends.y);
        lowest_z = hn::Min(lowest_z, ends.z);
        highest_x = hn::Max(highest_x, ends.x);
        highest_y = hn::Max(highest_y, ends.y);
        highest_z = hn::Max(highest_z, ends.z);
        hn::StoreU(ends.x, f, image.end_x.data() + at);
        hn::StoreU(ends.y, f, image.end_y.data() + at);
        hn::StoreU(ends.z, f, image.end_z.data() + at);
        ends.range_m = hn::IfThenElse(is_used, ends.range_m, hn::Set(d, -1.0));
        const hn::RebindToUnsigned<Ints> keys;
        const auto xy = hn::Or(key_of(scaled_x, is_used), hn::ShiftLeft<16>(key_of(scaled_y, is_used)));
        hn::StoreU(hn::BitCast(keys, xy), keys, image.key_xy.data() + at);
        const auto key_z = hn::BitCast(keys, key_of(scaled_z, is_used));
        const auto ends_f = hn::Ge(hn::DemoteTo(f, ends.range_m), hn::Zero(f));
        hn::StoreU(hn::IfThenElse(hn::RebindMask(keys, ends_f), key_z, hn::Set(keys, ProjectedImage::kNoKey)),
                   keys, image.key_z.data() + at);
        hn::StoreU(hn::IfThenElse(is_used_f, ends.reach_m, hn::Set(f, -1.0F)), f, image.reach_m.data() + at);
        hn::StoreU(ends.range_m, d, image.range_m.data() + at);

        // A ray without an end at a surface does not pass the voxel in which it ends.
        const Mask is_less =
            hn::Or(hn::Lt(ends.range_m, hn::Zero(d)),
                   hn::Or(is_at_face(scaled_x), hn::Or(is_at_face(scaled_y), is_at_face(scaled_z))));
        const Float passed =
            hn::Sub(ends.reach_m, hn::IfThenElseZero(narrow(is_less), hn::Set(f, to.half_depth_m)));
        hn::StoreU(hn::IfThenElse(is_used_f, passed, hn::Set(f, -1.0F)), f, image.passed_m.data() + at);
    }
    const auto least = [](Float values) { return hn::GetLane(hn::MinOfLanes(Floats(), values)); };
    const auto most = [](Float values) { return hn::GetLane(hn::MaxOfLanes(Floats(), values)); };
    sums.bound({least(lowest_x), least(lowest_y), least(lowest_z)});
    sums.bound({most(highest_x), most(highest_y), most(highest_z)});
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(place_row);

void resize(ProjectedImage& image, std::size_t entries) {
    for (auto* values : {&image.end_x, &image.end_y, &image.end_z, &image.reach_m, &image.passed_m})
        values->resize(entries);
    image.range_m.resize(entries);
    image.key_xy.resize(entries);
    image.key_z.resize(entries);
}

}  // namespace

void place_image(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                 const Eigen::Isometry3d& T_map_camera, double range_max_m, ProjectedImage& placed,
                 ThreadPool* pool) {
    const std::size_t pixels = std::size_t{image.width} * image.height;
    assert(image.width == pixel_rays.camera().width && image.height == pixel_rays.camera().height);
    assert(image.depth_m.size() == pixels);
    placed.width = image.width;
    placed.height = image.height;
    placed.origin = T_map_camera.translation().cast<float>();
    resize(placed, pixels + kLanesMax);

    Placement to{.T = {},
                 .voxels_per_m = 1.0 / lattice.resolution_m(),
                 .range_max_m = static_cast<float>(range_max_m),
                 .half_depth_m = static_cast<float>(0.5 * lattice.resolution_m() *
                                                    T_map_camera.linear().col(2).lpNorm<1>())};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 4; ++j)
            to.T[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = T_map_camera(i, j);
    }
    const ImageBands bands = bands_of(image.width, image.height);
    std::vector<RowSums> sums(bands.count, {{}, placed.origin, placed.origin});
    for_each_band(bands, image.height, pool, [&](std::size_t band, std::uint32_t begin, std::uint32_t end) {
        std::vector<float> depth_m(image.width + kLanesMax, std::numeric_limits<float>::quiet_NaN());
        std::vector<double> ray_x(image.width + kLanesMax);
        std::vector<double> ray_y(image.width + kLanesMax);
        for (std::uint32_t v = begin; v < end; ++v) {
            const std::size_t first = std::size_t{v} * image.width;
            std::copy_n(image.depth_m.begin() + static_cast<std::ptrdiff_t>(first), image.width,
                        depth_m.begin());
            for (std::uint32_t u = 0; u < image.width; ++u) {
                const RaySlope ray = pixel_rays.at(u, v);
                ray_x[u] = ray.x;
                ray_y[u] = ray.y;
            }
            HWY_DYNAMIC_DISPATCH(place_row)
            (to, {depth_m.data(), ray_x.data(), ray_y.data(), first, image.width}, placed, sums[band]);
        }
    });
    take_sums(sums, placed);
    for (auto* values : {&placed.reach_m, &placed.passed_m}) {
        std::fill(values->begin() + static_cast<std::ptrdiff_t>(pixels), values->end(), -1.0F);
    }
}

}  // namespace octoskin
#endif
