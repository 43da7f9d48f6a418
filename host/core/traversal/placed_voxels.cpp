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

#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_PLACED_VOXELS_TYPES
#define OCTOSKIN_PLACED_VOXELS_TYPES
namespace octoskin {

/// What does not change from pixel to pixel.
struct VoxelPlacement {
    std::array<std::array<float, 4>, 3> T;  ///< map from camera, row by row
    float voxels_per_m = 0.0F;
    float resolution_m = 0.0F;
    float range_max_m = 0.0F;   ///< infinite: none
    float half_depth_m = 0.0F;  ///< of a voxel, along the optical axis
    /// Rounding may decide on which side of a face an end lies that is no further from it, in voxels: of a
    /// point at the camera, and so much more for each metre of its camera coordinates' sum.
    float unsure = 0.0F;
    float unsure_per_m = 0.0F;
};

/// A row of the image; as many entries as a vector holds may be read beyond its end.
struct RowOfDepths {
    const float* depth_m;  ///< NaN beyond the row's end
    const float* ray_x;
    const float* ray_y;
    std::size_t first = 0;  ///< pixel of the image
    std::size_t width = 0;
};

/// What rows add up to.
struct SumsOfRows {
    DepthPixelCounts counts;
    Eigen::Vector3f lowest;
    Eigen::Vector3f highest;
    void bound(const Eigen::Vector3f& end) {
        lowest = lowest.cwiseMin(end);
        highest = highest.cwiseMax(end);
    }
};

/// Nearer to a voxel's face, in voxels and as a share of the coordinate, rounding may decide on which side an
/// end lies: as OctoMap walks, its ray may neither pass nor end in the voxel before the face.
inline constexpr double kAtFace = 1e-3;
inline constexpr double kAtFaceShare = 4e-6;
/// So near to the maximum range, as a share of it, rounding may decide whether a ray ends there.
inline constexpr float kAtRangeMax = 1e-5F;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sixteen at most: the bits of a mask then fit two bytes.
using Tag = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Tag>;

/// One coordinate of ends in the map, metres.
HWY_INLINE Lanes moved(const std::array<float, 4>& row, Lanes x, Lanes y, Lanes z) {
    const Tag f;
    const Lanes sum = hn::Add(hn::Add(hn::Mul(hn::Set(f, row[0]), x), hn::Mul(hn::Set(f, row[1]), y)),
                              hn::Mul(hn::Set(f, row[2]), z));
    return hn::Add(sum, hn::Set(f, row[3]));
}

HWY_INLINE Lanes from_face(Lanes scaled) {
    return hn::Abs(hn::Sub(scaled, hn::Round(scaled)));
}

/// Places what is sure, and sets a bit for each pixel of the row that is not, in whole words.
void place_sure(const VoxelPlacement& to, const RowOfDepths& row, PlacedImage& image, SumsOfRows& sums,
                std::uint64_t* unsure) {
    const Tag f;
    const hn::RebindToSigned<Tag> i;
    const hn::RebindToUnsigned<Tag> k;
    const Lanes zero = hn::Zero(f);
    const Lanes none = hn::Set(f, -1.0F);
    const Lanes range_max = hn::Set(f, to.range_max_m);
    const Lanes edge = hn::Set(f, static_cast<float>(kOriginKey));
    Lanes lowest[3], highest[3];
    for (int axis = 0; axis < 3; ++axis) lowest[axis] = highest[axis] = hn::Set(f, image.origin[axis]);
    for (std::size_t u = 0; u < row.width; u += hn::Lanes(f)) {
        const Lanes depth = hn::LoadU(f, row.depth_m + u);
        const Lanes ray_x = hn::LoadU(f, row.ray_x + u);
        const Lanes ray_y = hn::LoadU(f, row.ray_y + u);
        const Lanes measured_x = hn::Mul(depth, ray_x);
        const Lanes measured_y = hn::Mul(depth, ray_y);
        const Lanes range =
            hn::Sqrt(hn::Add(hn::Add(hn::Mul(measured_x, measured_x), hn::Mul(measured_y, measured_y)),
                             hn::Mul(depth, depth)));
        const auto is_beyond = hn::Gt(range, range_max);
        const Lanes reach = hn::IfThenElse(is_beyond, hn::Div(hn::Mul(depth, range_max), range), depth);
        const Lanes x = hn::Mul(reach, ray_x);
        const Lanes y = hn::Mul(reach, ray_y);
        const Lanes ends[3] = {moved(to.T[0], x, y, reach), moved(to.T[1], x, y, reach),
                               moved(to.T[2], x, y, reach)};
        Lanes scaled[3];
        for (int axis = 0; axis < 3; ++axis) scaled[axis] = hn::Mul(ends[axis], hn::Set(f, to.voxels_per_m));
        const Lanes furthest = hn::Max(hn::Abs(scaled[0]), hn::Max(hn::Abs(scaled[1]), hn::Abs(scaled[2])));
        const Lanes extent = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), reach);
        const Lanes margin =
            hn::Add(hn::Add(hn::Set(f, to.unsure), hn::Mul(hn::Set(f, to.unsure_per_m), extent)),
                    hn::Mul(hn::Set(f, static_cast<float>(kAtFaceShare)), furthest));
        const Lanes to_face =
            hn::Min(from_face(scaled[0]), hn::Min(from_face(scaled[1]), from_face(scaled[2])));

        const auto in_row = hn::FirstN(f, row.width - u);
        const auto is_number = hn::Eq(depth, depth);
        const auto is_good = hn::And(hn::Gt(depth, zero), hn::Lt(depth, hn::Set(f, HUGE_VALF)));
        // Of a ray that ends in nothing the voxel matters only where the octree ends.
        const auto is_at_face =
            hn::And(hn::Lt(to_face, margin),
                    hn::Or(hn::Not(is_beyond), hn::Gt(furthest, hn::Sub(edge, hn::Set(f, 1.0F)))));
        const auto is_at_max =
            hn::Lt(hn::Abs(hn::Sub(range, range_max)), hn::Add(hn::Mul(hn::Set(f, kAtRangeMax), range_max),
                                                               hn::Mul(margin, hn::Set(f, to.resolution_m))));
        const auto is_unsure = hn::And(hn::And(in_row, is_good), hn::Or(is_at_face, is_at_max));
        const auto has_keys = hn::Lt(furthest, edge);
        const auto is_sure = hn::AndNot(is_unsure, hn::And(in_row, is_good));
        const auto is_used = hn::And(is_sure, has_keys);
        const std::size_t used = hn::CountTrue(f, is_used);
        sums.counts.used += used;
        if (used < hn::Lanes(f)) {
            sums.counts.no_value += hn::CountTrue(f, hn::AndNot(is_number, in_row));
            sums.counts.bad_value += hn::CountTrue(f, hn::AndNot(is_good, hn::And(in_row, is_number)));
            sums.counts.outside_map += hn::CountTrue(f, hn::AndNot(has_keys, is_sure));
        }
        unsure[u / 64] = (u % 64 == 0 ? 0 : unsure[u / 64]) | bits_of(f, is_unsure) << (u % 64);

        for (int axis = 0; axis < 3; ++axis) {
            lowest[axis] = hn::IfThenElse(is_used, hn::Min(lowest[axis], ends[axis]), lowest[axis]);
            highest[axis] = hn::IfThenElse(is_used, hn::Max(highest[axis], ends[axis]), highest[axis]);
        }
        const auto key_of = [&](Lanes along) HWY_ATTR {
            const Lanes floored = hn::Floor(hn::IfThenElseZero(is_used, along));
            return hn::BitCast(k, hn::Add(hn::ConvertTo(i, floored), hn::Set(i, kOriginKey)));
        };
        const auto ends_in_something = hn::AndNot(is_beyond, is_used);
        const std::size_t at = row.first + u;
        hn::StoreU(hn::Or(key_of(scaled[0]), hn::ShiftLeft<16>(key_of(scaled[1]))), k,
                   image.key_xy.data() + at);
        hn::StoreU(hn::IfThenElse(hn::RebindMask(k, ends_in_something), key_of(scaled[2]),
                                  hn::Set(k, PlacedImage::kNoKey)),
                   k, image.key_z.data() + at);
        hn::StoreU(hn::IfThenElse(ends_in_something, range, none), f, image.distance_m.data() + at);
        hn::StoreU(hn::IfThenElse(is_used, reach, none), f, image.reach_m.data() + at);
        const Lanes passed = hn::Sub(reach, hn::IfThenElseZero(is_beyond, hn::Set(f, to.half_depth_m)));
        hn::StoreU(hn::IfThenElse(is_used, passed, none), f, image.passed_m.data() + at);
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

/// A vector of any instruction set holds no more entries.
constexpr std::size_t kLanesMax = 64;

/// How many rows one of a crew places at a time. What is written beyond the end of a row that is no multiple
/// of a vector the next row overwrites, so that one has to do all of them.
std::uint32_t rows_of_band(std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t kBandRows = 32;
    return width % kLanesMax == 0 ? kBandRows : std::max(height, 1U);
}

/// One image, placed row by row.
class Placer {
  public:
    Placer(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
           const Eigen::Isometry3d& T_map_camera, double range_max_m, PlacedImage& placed)
        : image_(image),
          pixel_rays_(pixel_rays),
          lattice_(lattice),
          T_map_camera_(T_map_camera),
          placed_(placed) {
        to_.voxels_per_m = static_cast<float>(1.0 / lattice.resolution_m());
        to_.resolution_m = static_cast<float>(lattice.resolution_m());
        to_.range_max_m =
            range_max_m > 0.0 ? static_cast<float>(range_max_m) : std::numeric_limits<float>::infinity();
        to_.half_depth_m =
            static_cast<float>(0.5 * lattice.resolution_m() * T_map_camera.linear().col(2).lpNorm<1>());
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 4; ++j)
                to_.T[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
                    static_cast<float>(T_map_camera(i, j));
        }
        // Each of a dozen roundings is 6e-8 of what it rounds, at most the sum of all terms.
        constexpr double kRoundings = 1e-6;
        const double per_voxel = kRoundings / lattice.resolution_m();
        to_.unsure = static_cast<float>(kAtFace + per_voxel * T_map_camera.translation().lpNorm<1>());
        to_.unsure_per_m = static_cast<float>(per_voxel);
    }

    [[nodiscard]] SumsOfRows none() const { return {{}, placed_.origin, placed_.origin}; }

    void place_rows(std::uint32_t begin, std::uint32_t end, SumsOfRows& sums) const {
        std::vector<float> depth_m(image_.width + kLanesMax, std::numeric_limits<float>::quiet_NaN());
        std::vector<float> ray_x(image_.width + kLanesMax);
        std::vector<float> ray_y(image_.width + kLanesMax);
        std::vector<std::uint64_t> unsure((image_.width + 63) / 64);
        const bool is_pinhole = pixel_rays_.camera().lens.is_none();
        for (std::uint32_t v = begin; v < end; ++v) {
            const std::size_t first = std::size_t{v} * image_.width;
            std::copy_n(image_.depth_m.begin() + static_cast<std::ptrdiff_t>(first), image_.width,
                        depth_m.begin());
            if (is_pinhole && v > begin) {  // whose columns' x is that of every row
                std::fill(ray_y.begin(), ray_y.end(), static_cast<float>(pixel_rays_.at(0, v).y));
            } else {
                take_rays(v, ray_x, ray_y);
            }
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
    void take_rays(std::uint32_t v, std::vector<float>& ray_x, std::vector<float>& ray_y) const {
        for (std::uint32_t u = 0; u < image_.width; ++u) {
            const RaySlope ray = pixel_rays_.at(u, v);
            ray_x[u] = static_cast<float>(ray.x);
            ray_y[u] = static_cast<float>(ray.y);
        }
    }

    /// As place_image() does.
    void place_exactly(std::uint32_t u, std::uint32_t v, SumsOfRows& sums) const {
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
        placed_.key_z[at] = is_beyond ? PlacedImage::kNoKey : key->z;
        placed_.reach_m[at] = reach_m;
        placed_.passed_m[at] = is_beyond || is_at_face(end) ? reach_m - to_.half_depth_m : reach_m;
        // In the vectors' arithmetic: how many are placed together must not matter.
        const float x = depth_m * static_cast<float>(ray.x);
        const float y = depth_m * static_cast<float>(ray.y);
        placed_.distance_m[at] = is_beyond ? -1.0F : std::sqrt(x * x + y * y + depth_m * depth_m);
    }

    [[nodiscard]] bool is_at_face(const Eigen::Vector3f& end) const {
        const Eigen::Array3d scaled = end.cast<double>().array() / lattice_.resolution_m();
        return ((scaled - scaled.round()).abs() < kAtFace + kAtFaceShare * scaled.abs()).any();
    }

    const DepthImage& image_;
    const PixelRays& pixel_rays_;
    const VoxelLattice& lattice_;
    const Eigen::Isometry3d& T_map_camera_;
    PlacedImage& placed_;
    VoxelPlacement to_;
};

void resize(PlacedImage& image, std::size_t entries) {
    image.range_m.clear();
    image.reach_m.resize(entries);
    image.passed_m.resize(entries);
    image.distance_m.resize(entries);
    image.key_xy.resize(entries);
    image.key_z.resize(entries);
}

}  // namespace

void place_voxels(const DepthImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                  const Eigen::Isometry3d& T_map_camera, double range_max_m, PlacedImage& placed,
                  Crew* crew) {
    const std::size_t pixels = std::size_t{image.width} * image.height;
    assert(image.width == pixel_rays.camera().width && image.height == pixel_rays.camera().height);
    assert(image.depth_m.size() == pixels);
    placed.width = image.width;
    placed.height = image.height;
    placed.origin = T_map_camera.translation().cast<float>();
    resize(placed, pixels + kLanesMax);

    const Placer placer(image, pixel_rays, lattice, T_map_camera, range_max_m, placed);
    const std::uint32_t band_rows = rows_of_band(image.width, image.height);
    std::vector<SumsOfRows> sums((image.height + band_rows - 1) / band_rows, placer.none());
    Crew alone(1);
    (crew == nullptr ? alone : *crew).work(sums.size(), [&](std::size_t band) {
        const auto begin = static_cast<std::uint32_t>(band) * band_rows;
        placer.place_rows(begin, std::min(begin + band_rows, image.height), sums[band]);
    });
    SumsOfRows all = placer.none();
    for (const SumsOfRows& of_band : sums) {
        all.counts += of_band.counts;
        all.bound(of_band.lowest);
        all.bound(of_band.highest);
    }
    placed.counts = all.counts;
    placed.lowest = all.lowest;
    placed.highest = all.highest;
    for (auto* values : {&placed.reach_m, &placed.passed_m})
        std::fill(values->begin() + static_cast<std::ptrdiff_t>(pixels), values->end(), -1.0F);
}

}  // namespace octoskin
#endif
