// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/certain_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/open_voxels.hpp"
#include "host/core/traversal/picture_test.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_CERTAIN_VOXELS_TYPES
#define OCTOSKIN_CERTAIN_VOXELS_TYPES
namespace octoskin {

/// The camera in single precision. Pixel (u, v) is seen along ((u - u_centre) / fx, (v - v_centre) / fy, 1).
struct CertainTest {
    const float* passed_m = nullptr;
    float width = 0.0F;
    float last_u = 0.0F;
    float last_v = 0.0F;
    float fx = 0.0F;
    float fy = 0.0F;
    float u_centre = 0.0F;
    float v_centre = 0.0F;
    std::array<Eigen::Vector3f, 3> along;  ///< of the map's axes, one voxel, in the camera's frame
    float inside_squared = 0.0F;           ///< how near a ray passes the centre, squared, metres
    float beyond_m = 0.0F;                 ///< how much further than the centre it goes on
    float near_m = 0.0F;                   ///< nearer than this no pixel is the nearest
    float far_m = 0.0F;
};

/// Of a row of eight voxels, a bit each.
struct RowBits {
    unsigned certain = 0;
    unsigned open = 0;  ///< the nearest pixel does not tell
};

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
        const V passed = hn::GatherIndex(f, test.passed_m, pixel);
        const auto reaches = hn::Gt(passed, hn::Add(z, hn::Set(f, test.beyond_m)));
        const auto tells = hn::And(passes, hn::Ge(passed, hn::Zero(f)));
        row.certain |= static_cast<unsigned>(bits_of(f, hn::And(passes, reaches)) << first);
        const auto is_open = hn::AndNot(
            tells, hn::And(hn::Le(z, hn::Set(f, test.far_m)), hn::Gt(z, hn::Set(f, -test.near_m))));
        row.open |= static_cast<unsigned>(bits_of(f, is_open) << first);
    }
    return row;
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

void mark_all(std::uint8_t* marks, std::ptrdiff_t y_stride, std::ptrdiff_t z_stride) {
    constexpr std::uint64_t kEight = MarkGrid::kPassed * 0x0101010101010101ULL;
    for (int z = 0; z < kBrick; ++z) {
        for (int y = 0; y < kBrick; ++y)
            std::memcpy(marks + y * y_stride + z * z_stride, &kEight, sizeof(kEight));
    }
}

CertainTest test_of(const CertainView& view, const PlacedImage& image) {
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
    return test;
}

}  // namespace

void mark_certain_voxels(const CertainView& view, const PlacedImage& image, const ReachWindows& reach,
                         const VoxelLattice& lattice, MarkGrid& grid, std::vector<RayPiece>& pieces) {
    if (!(view.depth_max_m > 0.0)) return;
    const CertainTest test = test_of(view, image);
    const PictureTest picture(view, reach);
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
                const Eigen::Vector3d middle = view.T_camera_map * (first + to_middle);
                if (middle.z() - kBrick * view.half_depth_m > view.depth_max_m) continue;
                const CubeVerdict verdict = picture.of_cube(middle, kBrick);
                if (verdict == CubeVerdict::none) continue;
                std::uint8_t* const marks =
                    grid.marks() + grid.index_of(corner[0] + x, corner[1] + y, corner[2] + z);
                if (verdict == CubeVerdict::all) {
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
