// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/certain_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/reach_blocks.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#ifndef OCTOSKIN_CERTAIN_VOXELS_TYPES
#define OCTOSKIN_CERTAIN_VOXELS_TYPES
namespace octoskin {

/// The camera in single precision. Pixel (u, v) is seen along ((u - u_centre) / fx, (v - v_centre) / fy, 1).
struct CertainTest {
    const float* reach_m = nullptr;
    float width = 0.0F;
    float last_u = 0.0F;
    float last_v = 0.0F;
    float fx = 0.0F;
    float fy = 0.0F;
    float u_centre = 0.0F;
    float v_centre = 0.0F;
    std::array<Eigen::Vector3f, 3> along;  ///< of the map's axes, one voxel, in the camera's frame
    float inside_squared = 0.0F;           ///< how near a ray passes the centre, squared, metres
    float beyond_m = 0.0F;                 ///< how much further than the centre it reaches
    float near_m = 0.0F;                   ///< nearer than this no pixel is the nearest
    float far_m = 0.0F;
};

/// Of a row of eight voxels, a bit each.
struct RowBits {
    unsigned certain = 0;
    unsigned open = 0;  ///< the nearest pixel does not tell
};

/// A voxel as pixels in a row see it: its faces along each axis of the map, from the camera, metres, the
/// voxel made a little smaller and a little larger; and the directions of the row's rays, those of its first
/// pixel and what each next one adds, per metre of depth.
struct RowOfRays {
    std::array<float, 3> centre;
    std::array<float, 3> first;
    std::array<float, 3> next;
    /// 1 or -1 along an axis on whose upper or lower side of the origin's voxel this one lies, else 0: a ray
    /// that goes the other way never comes there, whatever is rounded.
    std::array<float, 3> side;
    float half_smaller = 0.0F;
    float half_larger = 0.0F;
    float margin_m = 0.0F;
};

enum class Passing : std::uint8_t { none, perhaps, certain };

inline constexpr int kBrick = MarkGrid::kBrick;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, MarkGrid::kBrick>;
using I = hn::RebindToSigned<F>;
using V = hn::Vec<F>;

/// The first one's centre at `p_camera`.
HWY_INLINE RowBits test_row(const CertainTest& test, const Eigen::Vector3f& p_camera) {
    const F f;
    const I i;
    RowBits row;
    const auto bits_of = [&](auto mask, std::size_t first) {
        std::array<std::uint8_t, 8> bits{};
        hn::StoreMaskBits(f, mask, bits.data());
        return static_cast<unsigned>(bits[0] & ((1U << hn::Lanes(f)) - 1U)) << first;
    };
    for (std::size_t first = 0; first < static_cast<std::size_t>(kBrick); first += hn::Lanes(f)) {
        const V at = hn::Iota(f, static_cast<float>(first));
        const V x = hn::Add(hn::Set(f, p_camera.x()), hn::Mul(at, hn::Set(f, test.along[0].x())));
        const V y = hn::Add(hn::Set(f, p_camera.y()), hn::Mul(at, hn::Set(f, test.along[0].y())));
        const V z = hn::Add(hn::Set(f, p_camera.z()), hn::Mul(at, hn::Set(f, test.along[0].z())));
        const V per_z = hn::Div(hn::Set(f, 1.0F), hn::Max(z, hn::Set(f, test.near_m)));
        const auto nearest = [&](V across, float focal, float centre, float last) {
            const V pixel = hn::Add(hn::Mul(hn::Mul(across, per_z), hn::Set(f, focal)), hn::Set(f, centre));
            // Of a centre beside the picture the nearest is at its edge, and perhaps too far away.
            return hn::Min(hn::Max(hn::Round(pixel), hn::Zero(f)), hn::Set(f, last));
        };
        const V u = nearest(x, test.fx, test.u_centre, test.last_u);
        const V v = nearest(y, test.fy, test.v_centre, test.last_v);
        const V ray_x = hn::Mul(hn::Sub(u, hn::Set(f, test.u_centre)), hn::Set(f, 1.0F / test.fx));
        const V ray_y = hn::Mul(hn::Sub(v, hn::Set(f, test.v_centre)), hn::Set(f, 1.0F / test.fy));
        const V off_x = hn::Sub(x, hn::Mul(ray_x, z));
        const V off_y = hn::Sub(y, hn::Mul(ray_y, z));
        const auto passes = hn::And(
            hn::Gt(z, hn::Set(f, test.near_m)),
            hn::Le(hn::Add(hn::Mul(off_x, off_x), hn::Mul(off_y, off_y)), hn::Set(f, test.inside_squared)));
        const auto pixel = hn::ConvertTo(i, hn::Add(hn::Mul(v, hn::Set(f, test.width)), u));
        const V reach = hn::GatherIndex(f, test.reach_m, pixel);
        const auto reaches = hn::Gt(reach, hn::Add(z, hn::Set(f, test.beyond_m)));
        const auto tells = hn::And(passes, hn::Ge(reach, hn::Zero(f)));
        row.certain |= bits_of(hn::And(passes, reaches), first);
        row.open |= bits_of(hn::AndNot(tells, hn::And(hn::Le(z, hn::Set(f, test.far_m)),
                                                      hn::Gt(z, hn::Set(f, -test.near_m)))),
                            first);
    }
    return row;
}

using Wide = hn::ScalableTag<float>;

/// Do the rays of pixels `first` to `last` of the row pass the voxel? Adds those that perhaps do.
Passing test_rays(const RowOfRays& row, const float* reach_m, std::uint32_t first, std::uint32_t last,
                  std::uint32_t pixel_of_row, std::vector<std::uint32_t>& perhaps) {
    const Wide f;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(f));
    Passing passing = Passing::none;
    for (std::uint32_t u = first; u <= last; u += lanes) {
        const auto at = hn::Iota(f, static_cast<float>(u));
        auto in_smaller = hn::Set(f, row.margin_m);
        auto in_larger = hn::Zero(f);
        auto out_smaller = hn::Set(f, std::numeric_limits<float>::infinity());
        auto out_larger = out_smaller;
        auto may_pass = hn::FirstN(f, last + 1 - u);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto direction =
                hn::Add(hn::Set(f, row.first[axis]), hn::Mul(at, hn::Set(f, row.next[axis])));
            const auto per_direction = hn::Div(
                hn::Set(f, 1.0F), hn::CopySign(hn::Max(hn::Abs(direction), hn::Set(f, 1e-9F)), direction));
            constexpr float kStill = -1e-5F;  // and what single precision may make of it
            may_pass =
                hn::And(may_pass, hn::Ge(hn::Mul(direction, hn::Set(f, row.side[axis])), hn::Set(f, kStill)));
            const auto middle = hn::Mul(hn::Set(f, row.centre[axis]), per_direction);
            const auto smaller = hn::Mul(hn::Set(f, row.half_smaller), hn::Abs(per_direction));
            const auto larger = hn::Mul(hn::Set(f, row.half_larger), hn::Abs(per_direction));
            in_smaller = hn::Max(in_smaller, hn::Sub(middle, smaller));
            out_smaller = hn::Min(out_smaller, hn::Add(middle, smaller));
            in_larger = hn::Max(in_larger, hn::Sub(middle, larger));
            out_larger = hn::Min(out_larger, hn::Add(middle, larger));
        }
        const auto reach = hn::LoadU(f, reach_m + pixel_of_row + u);
        if (!hn::AllFalse(f,
                          hn::And(hn::FirstN(f, last + 1 - u),
                                  hn::And(hn::Lt(in_smaller, out_smaller),
                                          hn::Gt(reach, hn::Add(out_larger, hn::Set(f, row.margin_m))))))) {
            return Passing::certain;
        }
        may_pass = hn::And(may_pass, hn::And(hn::Le(in_larger, out_larger),
                                             hn::Ge(hn::Add(reach, hn::Set(f, row.margin_m)), in_larger)));
        if (hn::AllFalse(f, may_pass)) continue;
        passing = Passing::perhaps;
        std::array<std::uint8_t, hn::MaxLanes(Wide()) / 8 + 8> bits{};
        hn::StoreMaskBits(f, may_pass, bits.data());
        for (std::uint32_t lane = 0; lane < lanes; ++lane) {
            if ((bits[lane / 8] >> (lane % 8) & 1U) != 0) perhaps.push_back(pixel_of_row + u + lane);
        }
    }
    return passing;
}

/// `p_camera`: the centre of the brick's first voxel. `marks`: that voxel's. `open`: by row.
void test_brick(const CertainTest& test, const Eigen::Vector3f& p_camera, std::uint8_t* marks,
                std::ptrdiff_t y_stride, std::ptrdiff_t z_stride, std::uint8_t* open) {
    for (int z = 0; z < kBrick; ++z) {
        for (int y = 0; y < kBrick; ++y) {
            const Eigen::Vector3f first =
                p_camera + static_cast<float>(y) * test.along[1] + static_cast<float>(z) * test.along[2];
            const RowBits row = test_row(test, first);
            *open++ = static_cast<std::uint8_t>(row.open);
            if (row.certain == 0) continue;
            // Bit i to byte i.
            const std::uint64_t seven =
                (std::uint64_t{row.certain & 0x7FU} * 0x02040810204081ULL) & 0x0001010101010101ULL;
            const std::uint64_t eight = seven | (std::uint64_t{row.certain >> 7U} << 56U);
            std::memcpy(marks + y * y_stride + z * z_stride, &eight, sizeof(eight));
        }
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(test_brick);
HWY_EXPORT(test_rays);

enum class Verdict : std::uint8_t { none, some, all };

/// What the picture of a voxel, or of a brick of them, tells before any of its rays is looked at.
class PictureTest {
  public:
    PictureTest(const CertainView& view, const PlacedImage& image)
        : view_(view), camera_(view.camera), reach_(image) {
        const double left = camera_.cx / camera_.fx;
        const double right = (camera_.width - camera_.cx) / camera_.fx;
        const double top = camera_.cy / camera_.fy;
        const double bottom = (camera_.height - camera_.cy) / camera_.fy;
        sides_ = {Eigen::Vector3d(1.0, 0.0, left), Eigen::Vector3d(-1.0, 0.0, right),
                  Eigen::Vector3d(0.0, 1.0, top), Eigen::Vector3d(0.0, -1.0, bottom)};
        for (std::size_t i = 0; i < sides_.size(); ++i) {
            const Eigen::Vector3d normal_map = view.T_camera_map.linear().transpose() * sides_[i];
            half_edge_[i] = 0.5 * view.resolution_m * normal_map.lpNorm<1>() + view.margin_m;
        }
    }

    /// Of a cube of `voxels` along each edge, its centre in the camera's frame: no part is in the picture.
    [[nodiscard]] bool is_out_of_sight(const Eigen::Vector3d& centre, int voxels) const {
        if (centre.z() + voxels * view_.half_depth_m + view_.margin_m < 0.0) return true;
        for (std::size_t i = 0; i < sides_.size(); ++i) {
            if (centre.dot(sides_[i]) < -voxels * half_edge_[i]) return true;
        }
        return false;
    }

    /// The pixels that may see a cube; empty if that comes too near to the camera to tell.
    [[nodiscard]] std::optional<PixelBox> pixels_of(const Eigen::Vector3d& centre, int voxels) const {
        const double radius_m = voxels * view_.radius_m;
        const double nearest_m = centre.z() - radius_m;
        if (nearest_m < 0.5 * radius_m) return std::nullopt;
        const double u = camera_.fx * centre.x() / centre.z() + camera_.cx;
        const double v = camera_.fy * centre.y() / centre.z() + camera_.cy;
        const double x = centre.x() / centre.z();
        const double y = centre.y() / centre.z();
        const double u_apart = camera_.fx * radius_m * std::sqrt(1.0 + x * x) / nearest_m + 1.0;
        const double v_apart = camera_.fy * radius_m * std::sqrt(1.0 + y * y) / nearest_m + 1.0;
        const auto pixel = [](double value, std::uint32_t size) {
            return static_cast<std::uint32_t>(std::clamp(value, 0.0, size - 1.0));
        };
        return PixelBox{pixel(u - u_apart, camera_.width), pixel(u + u_apart, camera_.width),
                        pixel(v - v_apart, camera_.height), pixel(v + v_apart, camera_.height)};
    }
    [[nodiscard]] PixelBox all_pixels() const { return {0, camera_.width - 1, 0, camera_.height - 1}; }

    [[nodiscard]] Verdict of_brick(const Eigen::Vector3d& centre) const {
        const double half_depth_m = kBrick * view_.half_depth_m + view_.margin_m;
        const double nearest_m = centre.z() - half_depth_m;
        const double furthest_m = centre.z() + half_depth_m;
        if (nearest_m > view_.depth_max_m || is_out_of_sight(centre, kBrick)) return Verdict::none;
        const auto box = pixels_of(centre, kBrick);
        if (!box) return Verdict::some;
        const auto span = reach_.of(*box);
        if (static_cast<double>(span.longest) < nearest_m) return Verdict::none;
        const bool is_whole = box->u_first > 0 && box->u_last + 1 < camera_.width && box->v_first > 0 &&
                              box->v_last + 1 < camera_.height;
        const bool is_passed = static_cast<double>(span.shortest) > furthest_m;
        return is_whole && is_passed && furthest_m < view_.depth_max_m ? Verdict::all : Verdict::some;
    }

    [[nodiscard]] float longest(const PixelBox& box) const { return reach_.of(box).longest; }

  private:
    const CertainView& view_;
    CameraIntrinsics camera_;
    std::array<Eigen::Vector3d, 4> sides_;  ///< of the picture: their planes' normals, inwards
    std::array<double, 4> half_edge_{};     ///< how far a voxel reaches along each, and the margin
    ReachBlocks reach_;
};

/// Asks all pixels that see a voxel.
class OpenVoxels {
  public:
    OpenVoxels(const CertainView& view, const PlacedImage& image, const VoxelLattice& lattice,
               const PictureTest& picture)
        : view_(view),
          image_(image),
          picture_(picture),
          centre_of_origin_(lattice.centre_of(*lattice.key_of(image.origin.cast<double>()))),
          half_depth_m_(static_cast<float>(view.half_depth_m + view.margin_m)) {
        const CameraIntrinsics& camera = view.camera;
        const Eigen::Matrix3d R_map_camera = view.T_camera_map.linear().transpose();
        const Eigen::Vector3d corner((0.5 - camera.cx) / camera.fx, (0.5 - camera.cy) / camera.fy, 1.0);
        first_ = R_map_camera * corner;
        next_u_ = R_map_camera.col(0) / camera.fx;
        next_v_ = R_map_camera.col(1) / camera.fy;
    }

    /// True if the voxel is passed for certain; else `pieces` gets the rays that perhaps pass it.
    [[nodiscard]] bool is_passed(const Eigen::Vector3d& centre_map, std::vector<RayPiece>& pieces) {
        const Eigen::Vector3d centre = view_.T_camera_map * centre_map;
        if (picture_.is_out_of_sight(centre, 1)) return false;
        const PixelBox box = picture_.pixels_of(centre, 1).value_or(picture_.all_pixels());
        const auto z = static_cast<float>(centre.z());
        if (picture_.longest(box) < z - half_depth_m_) return false;

        const Eigen::Vector3d p = centre_map - image_.origin.cast<double>();
        const double half_edge_m = 0.5 * view_.resolution_m;
        RowOfRays row{.centre = array_of(p),
                      .first = {},
                      .next = array_of(next_u_),
                      .side = {},
                      .half_smaller = static_cast<float>(half_edge_m - view_.margin_m),
                      .half_larger = static_cast<float>(half_edge_m + view_.margin_m),
                      .margin_m = static_cast<float>(view_.margin_m)};
        for (Eigen::Index i = 0; i < 3; ++i) {
            const double away = centre_map[i] - centre_of_origin_[i];
            row.side[static_cast<std::size_t>(i)] = away > half_edge_m    ? 1.0F
                                                    : away < -half_edge_m ? -1.0F
                                                                          : 0.0F;
        }
        perhaps_.clear();
        const double v_middle =
            view_.camera.fy * centre.y() / std::max(centre.z(), half_edge_m) + view_.camera.cy;
        const auto middle = static_cast<std::int64_t>(std::clamp<double>(v_middle, box.v_first, box.v_last));
        // From the middle outwards: rays that pass are found soonest there.
        for (std::int64_t step = 0, v = middle;; ++step) {
            v += step % 2 == 0 ? step : -step;
            const bool is_above = v < box.v_first;
            const bool is_below = v > box.v_last;
            if (!is_above && !is_below) {
                row.first = array_of(first_ + static_cast<double>(v) * next_v_);
                const auto pixel_of_row = static_cast<std::uint32_t>(v) * image_.width;
                if (HWY_DYNAMIC_DISPATCH(test_rays)(row, image_.reach_m.data(), box.u_first, box.u_last,
                                                    pixel_of_row, perhaps_) == Passing::certain) {
                    return true;
                }
            }
            if (step > 2 * (static_cast<std::int64_t>(box.v_last) - box.v_first) + 2) break;
        }
        const float from_m = std::max(z - half_depth_m_, 0.0F);
        for (const std::uint32_t pixel : perhaps_) {
            if (from_m < image_.reach_m[pixel])
                pieces.push_back({pixel, from_m, std::max(z, 0.0F) + half_depth_m_});
        }
        return false;
    }

  private:
    [[nodiscard]] static std::array<float, 3> array_of(const Eigen::Vector3d& p) {
        return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
    }

    const CertainView& view_;
    const PlacedImage& image_;
    const PictureTest& picture_;
    Eigen::Vector3d centre_of_origin_;
    float half_depth_m_;
    Eigen::Vector3d first_;  ///< the ray of pixel (0, 0), map frame, per metre of depth
    Eigen::Vector3d next_u_;
    Eigen::Vector3d next_v_;
    std::vector<std::uint32_t> perhaps_;
};

void mark_all(std::uint8_t* marks, std::ptrdiff_t y_stride, std::ptrdiff_t z_stride) {
    constexpr std::uint64_t kEight = MarkGrid::kPassed * 0x0101010101010101ULL;
    for (int z = 0; z < kBrick; ++z) {
        for (int y = 0; y < kBrick; ++y)
            std::memcpy(marks + y * y_stride + z * z_stride, &kEight, sizeof(kEight));
    }
}

CertainTest test_of(const CertainView& view, const PlacedImage& image) {
    const CameraIntrinsics& camera = view.camera;
    CertainTest test{.reach_m = image.reach_m.data(),
                     .width = static_cast<float>(camera.width),
                     .last_u = static_cast<float>(camera.width - 1),
                     .last_v = static_cast<float>(camera.height - 1),
                     .fx = static_cast<float>(camera.fx),
                     .fy = static_cast<float>(camera.fy),
                     .u_centre = static_cast<float>(camera.cx - 0.5),
                     .v_centre = static_cast<float>(camera.cy - 0.5),
                     .along = {}};
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d step = view.resolution_m * view.T_camera_map.linear().col(axis);
        test.along[static_cast<std::size_t>(axis)] = step.cast<float>();
    }
    const double inside_m = 0.5 * view.resolution_m - 0.5 * view.margin_m;
    test.inside_squared = static_cast<float>(inside_m * inside_m);
    test.beyond_m = static_cast<float>(view.half_depth_m + 0.5 * view.margin_m);
    test.near_m = static_cast<float>(view.half_depth_m + view.margin_m);
    test.far_m = static_cast<float>(view.depth_max_m);
    return test;
}

}  // namespace

void mark_certain_voxels(const CertainView& view, const PlacedImage& image, const VoxelLattice& lattice,
                         MarkGrid& grid, std::vector<RayPiece>& pieces) {
    if (!(view.depth_max_m > 0.0)) return;
    const CertainTest test = test_of(view, image);
    const PictureTest picture(view, image);
    OpenVoxels open_voxels(view, image, lattice, picture);
    const auto corner = grid.corner();
    const auto size = grid.size();
    const auto stride = grid.stride();
    const double edge_m = lattice.resolution_m();
    const auto centre_of = [&](int key) { return (key - kOriginKey + 0.5) * edge_m; };
    const Eigen::Vector3d to_middle = Eigen::Vector3d::Constant(0.5 * (kBrick - 1) * edge_m);
    std::array<std::uint8_t, std::size_t{kBrick} * kBrick> open{};
    for (int z = 0; z < size[2]; z += kBrick) {
        for (int y = 0; y < size[1]; y += kBrick) {
            for (int x = 0; x < size[0]; x += kBrick) {
                const Eigen::Vector3d first(centre_of(corner[0] + x), centre_of(corner[1] + y),
                                            centre_of(corner[2] + z));
                const Verdict verdict = picture.of_brick(view.T_camera_map * (first + to_middle));
                if (verdict == Verdict::none) continue;
                std::uint8_t* const marks =
                    grid.marks() + grid.index_of(corner[0] + x, corner[1] + y, corner[2] + z);
                if (verdict == Verdict::all) {
                    mark_all(marks, stride[1], stride[2]);
                    continue;
                }
                const Eigen::Vector3f p_camera = (view.T_camera_map * first).cast<float>();
                HWY_DYNAMIC_DISPATCH(test_brick)(test, p_camera, marks, stride[1], stride[2], open.data());
                for (unsigned row = 0; row < open.size(); ++row) {
                    for (unsigned bits = open[row]; bits != 0; bits &= bits - 1) {
                        const int i = std::countr_zero(bits);
                        const auto j = static_cast<int>(row % kBrick);
                        const auto k = static_cast<int>(row / kBrick);
                        const Eigen::Vector3d centre = first + edge_m * Eigen::Vector3d(i, j, k);
                        if (open_voxels.is_passed(centre, pieces)) {
                            marks[i + j * stride[1] + k * stride[2]] = MarkGrid::kPassed;
                        }
                    }
                }
            }
        }
    }
}

}  // namespace octoskin
#endif
