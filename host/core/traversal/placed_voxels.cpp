// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/placed_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/placed_voxels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "host/core/traversal/image_bands.hpp"
#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_PLACED_VOXELS_TYPES
#define OCTOSKIN_PLACED_VOXELS_TYPES
namespace octoskin {

/// Values that are the same for all pixels.
struct VoxelPlacement {
    std::array<std::array<float, 4>, 3> T;  ///< map from camera, row by row
    float voxels_per_m = 0.0F;
    float resolution_m = 0.0F;
    float range_max_m = 0.0F;   ///< infinite: none
    float half_depth_m = 0.0F;  ///< of a voxel, along the optical axis
    /// An end within this distance of a face, in voxels, may be on either side by rounding: the value for a
    /// point at the camera, and the increase per metre of the sum of its camera coordinates.
    float unsure = 0.0F;
    float unsure_per_m = 0.0F;
};

/// A row of the image. Up to one vector may be read beyond its end.
struct RowOfDepths {
    const float* depth_m;  ///< NaN beyond the row's end
    const float* ray_x;
    const float* ray_y;
    std::size_t first = 0;  ///< pixel of the image
    std::size_t width = 0;
};

/// Within this share of the maximum range, rounding may decide whether a ray ends there.
inline constexpr float kAtRangeMax = 1e-5F;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sixteen lanes at most: the bits of a mask then fit two bytes.
using Tag = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Tag>;

/// One map coordinate of the ends, metres.
HWY_INLINE Lanes moved(const std::array<float, 4>& row, Lanes x, Lanes y, Lanes z) {
    const Tag f;
    const Lanes sum = hn::Add(hn::Add(hn::Mul(hn::Set(f, row[0]), x), hn::Mul(hn::Set(f, row[1]), y)),
                              hn::Mul(hn::Set(f, row[2]), z));
    return hn::Add(sum, hn::Set(f, row[3]));
}

HWY_INLINE Lanes from_face(Lanes scaled) {
    return hn::Abs(hn::Sub(scaled, hn::Round(scaled)));
}

/// Results for one vector of pixels.
struct Placed {
    Lanes reach_m;
    Lanes end_m[3];
    Lanes scaled[3];        ///< the end in voxels
    hn::Mask<Tag> is_good;  ///< there is a depth
    hn::Mask<Tag> is_beyond, has_keys, is_unsure;
};

HWY_INLINE Placed place(const VoxelPlacement& to, Lanes depth, Lanes ray_x, Lanes ray_y) {
    const Tag f;
    const Lanes range_max = hn::Set(f, to.range_max_m);
    const auto squared = [](Lanes value) HWY_ATTR { return hn::Mul(value, value); };
    Placed placed;
    placed.is_good = hn::And(hn::Gt(depth, hn::Zero(f)), hn::Lt(depth, hn::Set(f, HUGE_VALF)));
    const Lanes range_m = hn::Sqrt(
        hn::Add(hn::Add(squared(hn::Mul(depth, ray_x)), squared(hn::Mul(depth, ray_y))), squared(depth)));
    placed.is_beyond = hn::Gt(range_m, range_max);
    placed.reach_m = hn::IfThenElse(placed.is_beyond, hn::Div(hn::Mul(depth, range_max), range_m), depth);
    const Lanes x = hn::Mul(placed.reach_m, ray_x);
    const Lanes y = hn::Mul(placed.reach_m, ray_y);
    Lanes furthest = hn::Zero(f);
    Lanes to_face = hn::Set(f, 1.0F);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        placed.end_m[axis] = moved(to.T[axis], x, y, placed.reach_m);
        placed.scaled[axis] = hn::Mul(placed.end_m[axis], hn::Set(f, to.voxels_per_m));
        furthest = hn::Max(furthest, hn::Abs(placed.scaled[axis]));
        to_face = hn::Min(to_face, from_face(placed.scaled[axis]));
    }
    const Lanes extent = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), placed.reach_m);
    const Lanes margin = hn::Add(hn::Add(hn::Set(f, to.unsure), hn::Mul(hn::Set(f, to.unsure_per_m), extent)),
                                 hn::Mul(hn::Set(f, static_cast<float>(kAtFaceShare)), furthest));
    const Lanes edge = hn::Set(f, static_cast<float>(kOriginKey));
    // For a ray without an end at a surface, the voxel matters only at the octree's bounds.
    const auto is_at_face =
        hn::And(hn::Lt(to_face, margin),
                hn::Or(hn::Not(placed.is_beyond), hn::Gt(furthest, hn::Sub(edge, hn::Set(f, 1.0F)))));
    const auto is_at_max = hn::Lt(
        hn::Abs(hn::Sub(range_m, range_max)),
        hn::Add(hn::Mul(hn::Set(f, kAtRangeMax), range_max), hn::Mul(margin, hn::Set(f, to.resolution_m))));
    placed.is_unsure = hn::And(placed.is_good, hn::Or(is_at_face, is_at_max));
    placed.has_keys = hn::Lt(furthest, edge);
    return placed;
}

/// Returns the used pixels and counts the others.
HWY_INLINE hn::Mask<Tag> count(const Placed& placed, Lanes depth, hn::Mask<Tag> in_row,
                               DepthPixelCounts& counts) {
    const Tag f;
    const auto is_number = hn::Eq(depth, depth);
    const auto is_sure = hn::AndNot(placed.is_unsure, hn::And(in_row, placed.is_good));
    const auto is_used = hn::And(is_sure, placed.has_keys);
    const std::size_t used = hn::CountTrue(f, is_used);
    counts.used += used;
    if (used < hn::Lanes(f)) {
        counts.no_value += hn::CountTrue(f, hn::AndNot(is_number, in_row));
        counts.bad_value += hn::CountTrue(f, hn::AndNot(placed.is_good, hn::And(in_row, is_number)));
        counts.outside_map += hn::CountTrue(f, hn::AndNot(placed.has_keys, is_sure));
    }
    return is_used;
}

HWY_INLINE void store(const Placed& placed, hn::Mask<Tag> is_used, float half_depth_m, std::size_t at,
                      ProjectedImage& image) {
    const Tag f;
    const hn::RebindToSigned<Tag> i;
    const hn::RebindToUnsigned<Tag> k;
    const Lanes none = hn::Set(f, -1.0F);
    const auto key_of = [&](Lanes along) HWY_ATTR {
        const Lanes floored = hn::Floor(hn::IfThenElseZero(is_used, along));
        return hn::BitCast(k, hn::Add(hn::ConvertTo(i, floored), hn::Set(i, kOriginKey)));
    };
    const auto key_xy = hn::Or(key_of(placed.scaled[0]), hn::ShiftLeft<16>(key_of(placed.scaled[1])));
    hn::StoreU(key_xy, k, image.key_xy.data() + at);
    const auto ends_in_something = hn::AndNot(placed.is_beyond, is_used);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(k, ends_in_something), key_of(placed.scaled[2]),
                              hn::Set(k, ProjectedImage::kNoKey)),
               k, image.key_z.data() + at);
    hn::StoreU(hn::IfThenElse(is_used, placed.reach_m, none), f, image.reach_m.data() + at);
    const Lanes less = hn::IfThenElseZero(placed.is_beyond, hn::Set(f, half_depth_m));
    hn::StoreU(hn::IfThenElse(is_used, hn::Sub(placed.reach_m, less), none), f, image.passed_m.data() + at);
}

/// Projects the pixels with a certain result, and sets a bit, in whole words, for each other pixel of the
/// row.
void place_sure(const VoxelPlacement& to, const RowOfDepths& row, ProjectedImage& image, RowSums& sums,
                std::uint64_t* unsure) {
    const Tag f;
    Lanes lowest[3], highest[3];
    for (int axis = 0; axis < 3; ++axis) lowest[axis] = highest[axis] = hn::Set(f, image.origin[axis]);
    for (std::size_t u = 0; u < row.width; u += hn::Lanes(f)) {
        const Lanes depth = hn::LoadU(f, row.depth_m + u);
        const Placed placed = place(to, depth, hn::LoadU(f, row.ray_x + u), hn::LoadU(f, row.ray_y + u));
        const auto in_row = hn::FirstN(f, row.width - u);
        const auto is_used = count(placed, depth, in_row, sums.counts);
        const std::uint64_t bits = bits_of(f, hn::And(placed.is_unsure, in_row)) << (u % 64);
        unsure[u / 64] = (u % 64 == 0 ? 0 : unsure[u / 64]) | bits;
        for (int axis = 0; axis < 3; ++axis) {
            const Lanes end = placed.end_m[axis];
            lowest[axis] = hn::IfThenElse(is_used, hn::Min(lowest[axis], end), lowest[axis]);
            highest[axis] = hn::IfThenElse(is_used, hn::Max(highest[axis], end), highest[axis]);
        }
        store(placed, is_used, to.half_depth_m, row.first + u, image);
    }
    const auto least = [](Lanes values) { return hn::GetLane(hn::MinOfLanes(Tag(), values)); };
    const auto most = [](Lanes values) { return hn::GetLane(hn::MaxOfLanes(Tag(), values)); };
    sums.bound({least(lowest[0]), least(lowest[1]), least(lowest[2])});
    sums.bound({most(highest[0]), most(highest[1]), most(highest[2])});
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(place_sure);

/// Projects one image row by row.
class Placer {
  public:
    Placer(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
           const Eigen::Isometry3d& T_map_camera, double range_max_m, ProjectedImage& placed)
        : image_(image),
          pixel_rays_(pixel_rays),
          lattice_(lattice),
          T_map_camera_(T_map_camera),
          placed_(placed) {
        to_.voxels_per_m = static_cast<float>(1.0 / lattice.resolution_m());
        to_.resolution_m = static_cast<float>(lattice.resolution_m());
        const auto max_m = static_cast<float>(range_max_m);
        to_.range_max_m = max_m > 0.0F ? max_m : std::numeric_limits<float>::infinity();
        to_.half_depth_m =
            static_cast<float>(0.5 * lattice.resolution_m() * T_map_camera.linear().col(2).lpNorm<1>());
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 4; ++j)
                to_.T[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
                    static_cast<float>(T_map_camera(i, j));
        }
        // Each of about a dozen roundings is 6e-8 of its value, which is at most the sum of all terms.
        constexpr double kRoundings = 1e-6;
        const double per_voxel = kRoundings / lattice.resolution_m();
        to_.unsure = static_cast<float>(kAtFace + per_voxel * T_map_camera.translation().lpNorm<1>());
        to_.unsure_per_m = static_cast<float>(per_voxel);
    }

    void place_rows(std::uint32_t begin, std::uint32_t end, RowSums& sums) const {
        std::vector<float> depth_m(image_.width + kLanesMax, std::numeric_limits<float>::quiet_NaN());
        std::vector<float> ray_x(image_.width + kLanesMax);
        std::vector<float> ray_y(image_.width + kLanesMax);
        std::vector<std::uint64_t> unsure((image_.width + 63) / 64);
        // A pinhole's columns have the same x in every row, and its rows the same y in every column.
        for (std::uint32_t u = 0; u < image_.width; ++u)
            ray_x[u] = static_cast<float>(pixel_rays_.at(u, 0).x);
        for (std::uint32_t v = begin; v < end; ++v) {
            const std::size_t first = std::size_t{v} * image_.width;
            std::copy_n(image_.depth_m.begin() + static_cast<std::ptrdiff_t>(first), image_.width,
                        depth_m.begin());
            std::fill(ray_y.begin(), ray_y.end(), static_cast<float>(pixel_rays_.at(0, v).y));
            HWY_DYNAMIC_DISPATCH(place_sure)
            (to_, {depth_m.data(), ray_x.data(), ray_y.data(), first, image_.width}, placed_, sums,
             unsure.data());
            for (std::size_t word = 0; word < unsure.size(); ++word) {
                for (std::uint64_t bits = unsure[word]; bits != 0; bits &= bits - 1)
                    place_exactly(static_cast<std::uint32_t>(64 * word) +
                                      static_cast<std::uint32_t>(std::countr_zero(bits)),
                                  v, sums);
            }
        }
    }

  private:
    /// Same computation as place_image().
    void place_exactly(std::uint32_t u, std::uint32_t v, RowSums& sums) const {
        const std::size_t at = std::size_t{v} * image_.width + u;
        const float depth_m = image_.depth_m[at];
        const RaySlope ray = pixel_rays_.at(u, v);
        Eigen::Vector3f end =
            (T_map_camera_ * (static_cast<double>(depth_m) * Eigen::Vector3d(ray.x, ray.y, 1.0)))
                .cast<float>();
        float reach_m = depth_m;
        const Eigen::Vector3f along = end - placed_.origin;
        const double length_m = std::sqrt(
            static_cast<double>(along.x() * along.x() + along.y() * along.y() + along.z() * along.z()));
        const bool is_beyond = length_m > static_cast<double>(to_.range_max_m);
        if (is_beyond) {
            const auto length = static_cast<float>(length_m);
            end = placed_.origin + along / length * to_.range_max_m;
            reach_m *= to_.range_max_m / length;
        }
        const auto key = lattice_.key_of(end.cast<double>());
        if (!key) {
            ++sums.counts.outside_map;
            return;
        }
        ++sums.counts.used;
        sums.bound(end);
        placed_.key_xy[at] = key->x | std::uint32_t{key->y} << 16U;
        placed_.key_z[at] = is_beyond ? ProjectedImage::kNoKey : key->z;
        placed_.reach_m[at] = reach_m;
        placed_.passed_m[at] = is_beyond || is_at_face(end) ? reach_m - to_.half_depth_m : reach_m;
    }

    [[nodiscard]] bool is_at_face(const Eigen::Vector3f& end) const {
        const Eigen::Array3d scaled = (1.0 / lattice_.resolution_m()) * end.cast<double>().array();
        return ((scaled - scaled.round()).abs() < kAtFace + kAtFaceShare * scaled.abs()).any();
    }

    const DepthImage& image_;
    const PixelRays& pixel_rays_;
    const VoxelLattice& lattice_;
    const Eigen::Isometry3d& T_map_camera_;
    ProjectedImage& placed_;
    VoxelPlacement to_;
};

void resize(ProjectedImage& image, std::size_t entries) {
    for (auto* values : {&image.end_x, &image.end_y, &image.end_z}) values->clear();
    image.range_m.clear();
    image.reach_m.resize(entries);
    image.passed_m.resize(entries);
    image.key_xy.resize(entries);
    image.key_z.resize(entries);
}

}  // namespace

void place_voxels(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                  const Eigen::Isometry3d& T_map_camera, double range_max_m, ProjectedImage& placed,
                  ThreadPool* pool) {
    const std::size_t pixels = std::size_t{image.width} * image.height;
    assert(image.width == pixel_rays.camera().width && image.height == pixel_rays.camera().height);
    assert(image.depth_m.size() == pixels && pixel_rays.camera().lens.is_none());
    placed.width = image.width;
    placed.height = image.height;
    placed.origin = T_map_camera.translation().cast<float>();
    resize(placed, pixels + kLanesMax);

    const Placer placer(image, pixel_rays, lattice, T_map_camera, range_max_m, placed);
    const ImageBands bands = bands_of(image.width, image.height);
    std::vector<RowSums> sums(bands.count, {{}, placed.origin, placed.origin});
    for_each_band(bands, image.height, pool, [&](std::size_t band, std::uint32_t begin, std::uint32_t end) {
        placer.place_rows(begin, end, sums[band]);
    });
    take_sums(sums, placed);
    for (auto* values : {&placed.reach_m, &placed.passed_m})
        std::fill(values->begin() + static_cast<std::ptrdiff_t>(pixels), values->end(), -1.0F);
}

}  // namespace octoskin
#endif
