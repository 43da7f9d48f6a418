// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/certain_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/brick_visibility.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/open_voxels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_CERTAIN_VOXELS_TYPES
#define OCTOSKIN_CERTAIN_VOXELS_TYPES
namespace octoskin {

/// The camera in single precision. The direction of pixel (u, v) is ((u - u_centre) / fx, (v - v_centre) /
/// fy, 1).
struct CertainTest {
    const float* passed_m = nullptr;
    float width = 0.0F;
    float last_u = 0.0F;
    float last_v = 0.0F;
    float fx = 0.0F;
    float fy = 0.0F;
    float u_centre = 0.0F;
    float v_centre = 0.0F;
    std::array<Eigen::Vector3f, 3> along;  ///< one voxel along each map axis, in the camera's frame
    float inside_squared = 0.0F;  ///< limit of a ray's squared distance to the centre, metres squared
    float beyond_m = 0.0F;        ///< how far a ray must continue behind the centre
    /// Voxels nearer than this have no nearest pixel: half a voxel's depth plus the margin.
    float near_m = 0.0F;
    float far_m = 0.0F;
    std::int32_t blocks_width = 0;
    bool asks_all = false;  ///< all rays are tested, not only if the nearest pixel gives no decision
};

/// One bit for each voxel of a layer of 8 x 8, x first.
struct LayerBits {
    std::uint64_t certain = 0;
    std::uint64_t open = 0;  ///< the nearest pixel gives no decision
};

inline constexpr int kBrick = VisitedGrid::kBrick;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, VisitedGrid::kBrick>;
using I = hn::RebindToSigned<F>;
using V = hn::Vec<F>;

/// Voxels of a row, one per lane: their centres in the camera's frame, and their image positions. A voxel
/// nearer than `near_m` is projected as if at `near_m`.
struct LayerCentres {
    V x, y, z;
    V u, v;
};

/// The voxels from the `at`-th on, of a layer whose first voxel's centre is at `p_camera`.
HWY_INLINE LayerCentres centres_from(const CertainTest& test, const Eigen::Vector3f& p_camera,
                                     std::size_t at) {
    const F f;
    const Eigen::Vector3f row = p_camera + static_cast<float>(at / kBrick) * test.along[1];
    const V along = hn::Iota(f, static_cast<float>(at % kBrick));
    LayerCentres centres;
    centres.x = hn::Add(hn::Set(f, row.x()), hn::Mul(along, hn::Set(f, test.along[0].x())));
    centres.y = hn::Add(hn::Set(f, row.y()), hn::Mul(along, hn::Set(f, test.along[0].y())));
    centres.z = hn::Add(hn::Set(f, row.z()), hn::Mul(along, hn::Set(f, test.along[0].z())));
    const V per_z = hn::Div(hn::Set(f, 1.0F), hn::Max(centres.z, hn::Set(f, test.near_m)));
    const auto seen_at = [&](V across, float focal, float middle) HWY_ATTR {
        return hn::Add(hn::Mul(hn::Mul(across, per_z), hn::Set(f, focal)), hn::Set(f, middle));
    };
    centres.u = seen_at(centres.x, test.fx, test.u_centre);
    centres.v = seen_at(centres.y, test.fy, test.v_centre);
    return centres;
}

HWY_INLINE V in_picture(V pixel, float last) {
    const F f;
    return hn::Min(hn::Max(pixel, hn::Zero(f)), hn::Set(f, last));
}

/// Tests the pixel nearest to each centre.
HWY_INLINE LayerBits ask_nearest_pixels(const CertainTest& test, const Eigen::Vector3f& p_camera) {
    const F f;
    const I i;
    LookUps<F> passed_m;
    std::uint64_t passes = 0;    // the nearest pixel's ray passes the voxel's sphere
    std::uint64_t in_depth = 0;  // voxels that are open without a decision
    for (std::size_t at = 0; at < 64; at += hn::Lanes(f)) {
        const LayerCentres centres = centres_from(test, p_camera, at);
        // For a centre outside the image the nearest pixel is at the border, and possibly too far away.
        const V u = in_picture(hn::Round(centres.u), test.last_u);
        const V v = in_picture(hn::Round(centres.v), test.last_v);
        passed_m.put(at, hn::ConvertTo(i, hn::Add(hn::Mul(v, hn::Set(f, test.width)), u)));
        const V ray_x = hn::Mul(hn::Sub(u, hn::Set(f, test.u_centre)), hn::Set(f, 1.0F / test.fx));
        const V ray_y = hn::Mul(hn::Sub(v, hn::Set(f, test.v_centre)), hn::Set(f, 1.0F / test.fy));
        const V off_x = hn::Sub(centres.x, hn::Mul(ray_x, centres.z));
        const V off_y = hn::Sub(centres.y, hn::Mul(ray_y, centres.z));
        const V off_squared = hn::Add(hn::Mul(off_x, off_x), hn::Mul(off_y, off_y));
        passes |= bits_of(f, hn::And(hn::Gt(centres.z, hn::Set(f, test.near_m)),
                                     hn::Le(off_squared, hn::Set(f, test.inside_squared))))
                  << at;
        in_depth |= bits_of(f, hn::And(hn::Le(centres.z, hn::Set(f, test.far_m)),
                                       hn::Gt(centres.z, hn::Set(f, -test.near_m))))
                    << at;
    }
    passed_m.look_up(test.passed_m);
    std::uint64_t reaches = 0;
    std::uint64_t has_ray = 0;
    for (std::size_t at = 0; at < 64; at += hn::Lanes(f)) {
        const V passed = passed_m.values(at);
        const V z = centres_from(test, p_camera, at).z;
        reaches |= bits_of(f, hn::Gt(passed, hn::Add(z, hn::Set(f, test.beyond_m)))) << at;
        has_ray |= bits_of(f, hn::Ge(passed, hn::Zero(f))) << at;
    }
    const std::uint64_t certain = passes & reaches;
    return {certain, in_depth & ~(test.asks_all ? certain : passes & has_ray)};
}

/// Removes voxels that no ray in the square around them reaches.
HWY_INLINE std::uint64_t ask_windows(const CertainTest& test, const SquareOfPixels& square,
                                     const Eigen::Vector3f& p_camera) {
    const F f;
    const I i;
    LookUps<F> longest_m;
    for (std::size_t at = 0; at < 64; at += hn::Lanes(f)) {
        const LayerCentres centres = centres_from(test, p_camera, at);
        const auto first_block = [&](V middle, float last) HWY_ATTR {
            return hn::ShiftRight<1>(
                hn::ConvertTo(i, in_picture(hn::Sub(middle, hn::Set(f, square.half_px)), last)));
        };
        longest_m.put(at, hn::Add(hn::Mul(first_block(centres.v, test.last_v), hn::Set(i, test.blocks_width)),
                                  first_block(centres.u, test.last_u)));
    }
    longest_m.look_up(square.longest_m);
    std::uint64_t may_pass = 0;
    for (std::size_t at = 0; at < 64; at += hn::Lanes(f)) {
        const V nearest = hn::Sub(centres_from(test, p_camera, at).z, hn::Set(f, test.near_m));
        may_pass |= bits_of(f, hn::Ge(longest_m.values(at), nearest)) << at;
    }
    return may_pass;
}

/// `p_camera`: centre of the brick's first voxel. `marks`: that voxel's byte. `open`: bits by row.
void test_brick(const CertainTest& test, const SquareOfPixels& square, const Eigen::Vector3f& p_camera,
                std::uint8_t* marks, std::ptrdiff_t y_stride, std::ptrdiff_t z_stride, std::uint8_t* open) {
    for (int z = 0; z < kBrick; ++z) {
        const Eigen::Vector3f first = p_camera + static_cast<float>(z) * test.along[2];
        LayerBits layer = ask_nearest_pixels(test, first);
        if (layer.open != 0 && square.longest_m != nullptr) layer.open &= ask_windows(test, square, first);
        for (int y = 0; y < kBrick; ++y) {
            *open++ = static_cast<std::uint8_t>(layer.open >> (kBrick * y));
            const std::uint64_t certain = layer.certain >> (kBrick * y) & 0xFFU;
            if (certain == 0) continue;
            // Moves bit i to byte i.
            const std::uint64_t seven = ((certain & 0x7FU) * 0x02040810204081ULL) & 0x0001010101010101ULL;
            const std::uint64_t eight = seven | ((certain >> 7U) << 56U);
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

void mark_all(std::uint8_t* marks, std::ptrdiff_t y_stride, std::ptrdiff_t z_stride) {
    constexpr std::uint64_t kEight = VisitedGrid::kPassed * 0x0101010101010101ULL;
    for (int z = 0; z < kBrick; ++z) {
        for (int y = 0; y < kBrick; ++y)
            std::memcpy(marks + y * y_stride + z * z_stride, &kEight, sizeof(kEight));
    }
}

CertainTest test_of(const CertainView& view, const ProjectedImage& image, const RangePyramid& reach) {
    const CameraIntrinsics& camera = view.camera;
    CertainTest test{.passed_m = image.passed_m.data(),
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
    test.beyond_m = static_cast<float>(0.5 * view.margin_m);
    test.near_m = static_cast<float>(view.half_depth_m + view.margin_m);
    test.far_m = static_cast<float>(view.depth_max_m);
    test.blocks_width = static_cast<std::int32_t>(reach.columns());
    test.asks_all = view.is_by_voxel;
    return test;
}

using OpenRows = std::array<std::uint8_t, std::size_t{kBrick} * kBrick>;

/// Removes voxels in which rays end: for a hit it does not matter whether a ray also passes the voxel.
void leave_out(const EndsOfBrick& ends, const std::array<int, 3>& lowest, OpenRows& open) {
    if (std::ranges::all_of(open, [](std::uint8_t row) { return row == 0; })) return;
    for (const int key : lowest) {
        if (key < 0 || key >= kVoxelsPerAxis) return;  // no ray ends outside the keys
    }
    const BrickMask mask =
        ends(morton_of({static_cast<std::uint16_t>(lowest[0]), static_cast<std::uint16_t>(lowest[1]),
                        static_cast<std::uint16_t>(lowest[2])}));
    for (std::size_t word = 0; word < mask.size(); ++word) {
        for (std::uint64_t bits = mask[word]; bits != 0; bits &= bits - 1) {
            const VoxelKey at = key_of_morton(64 * word + static_cast<std::size_t>(std::countr_zero(bits)));
            open[at.y + std::size_t{kBrick} * at.z] &= static_cast<std::uint8_t>(~(1U << at.x));
        }
    }
}

}  // namespace

void mark_certain_voxels(const CertainView& view, const ProjectedImage& image, const RangePyramid& reach,
                         const VoxelLattice& lattice, const EndsOfBrick& ends, VisitedGrid& grid,
                         std::vector<RayPiece>& pieces) {
    if (!(view.depth_max_m > 0.0)) return;
    const CertainTest test = test_of(view, image, reach);
    const BrickVisibility picture(view, reach);
    OpenVoxels open_voxels(view, image, lattice, picture);
    const auto corner = grid.corner();
    const auto size = grid.size();
    const auto stride = grid.stride();
    const double edge_m = lattice.resolution_m();
    const auto centre_of = [&](int key) { return (key - kOriginKey + 0.5) * edge_m; };
    const Eigen::Vector3d to_middle = Eigen::Vector3d::Constant(0.5 * (kBrick - 1) * edge_m);
    OpenRows open{};
    for (int z = 0; z < size[2]; z += kBrick) {
        for (int y = 0; y < size[1]; y += kBrick) {
            for (int x = 0; x < size[0]; x += kBrick) {
                const Eigen::Vector3d first(centre_of(corner[0] + x), centre_of(corner[1] + y),
                                            centre_of(corner[2] + z));
                const Eigen::Vector3d middle = view.T_camera_map * (first + to_middle);
                if (middle.z() - kBrick * view.half_depth_m > view.depth_max_m) continue;
                const CubeCoverage verdict = picture.of_cube(middle, kBrick);
                if (verdict == CubeCoverage::none) continue;
                std::uint8_t* const marks =
                    grid.marks() + grid.index_of(corner[0] + x, corner[1] + y, corner[2] + z);
                if (verdict == CubeCoverage::all) {
                    mark_all(marks, stride[1], stride[2]);
                    continue;
                }
                const Eigen::Vector3f p_camera = (view.T_camera_map * first).cast<float>();
                const SquareOfPixels square = picture.square_of_voxels(middle, kBrick);
                HWY_DYNAMIC_DISPATCH(test_brick)
                (test, square, p_camera, marks, stride[1], stride[2], open.data());
                leave_out(ends, {corner[0] + x, corner[1] + y, corner[2] + z}, open);
                for (unsigned row = 0; row < open.size(); ++row) {
                    for (unsigned bits = open[row]; bits != 0; bits &= bits - 1) {
                        const int i = std::countr_zero(bits);
                        const auto j = static_cast<int>(row % kBrick);
                        const auto k = static_cast<int>(row / kBrick);
                        const Eigen::Vector3d centre = first + edge_m * Eigen::Vector3d(i, j, k);
                        if (open_voxels.is_passed(centre, pieces)) {
                            marks[i + j * stride[1] + k * stride[2]] = VisitedGrid::kPassed;
                        }
                    }
                }
            }
        }
    }
}

}  // namespace octoskin
#endif
