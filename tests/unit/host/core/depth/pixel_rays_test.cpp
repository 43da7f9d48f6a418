// The ray of each pixel. Oracle: OpenCV's published formula and its own inverse.
#include "host/core/depth/pixel_rays.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "tests/support/lens/published_lens.hpp"

namespace octoskin {
namespace {

using testing_support::kInvertibleTumCameras;
using testing_support::kTumCameras;
using testing_support::project;
using testing_support::PublishedCamera;
using testing_support::unproject;

CameraIntrinsics intrinsics_of(const PublishedCamera& camera) {
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    return {.width = 640,
            .height = 480,
            .fx = camera.fx,
            .fy = camera.fy,
            .cx = camera.cx + 0.5,
            .cy = camera.cy + 0.5,
            .lens = {.k1 = k1, .k2 = k2, .p1 = p1, .p2 = p2, .k3 = k3}};
}

TEST(PixelRays, of_every_pixel_comes_back_to_it_through_the_published_lens) {
    for (std::size_t i = 0; i < kInvertibleTumCameras; ++i) {
        const PublishedCamera& camera = kTumCameras.at(i);
        const PixelRays rays(intrinsics_of(camera));
        double error_px_max = 0.0;
        for (std::uint32_t v = 0; v < 480; ++v) {
            for (std::uint32_t u = 0; u < 640; ++u) {
                const auto [u_again, v_again] = project(camera, rays.at(u, v).x, rays.at(u, v).y);
                error_px_max = std::max(error_px_max, std::hypot(u_again - u, v_again - v));
            }
        }
        EXPECT_LT(error_px_max, 1e-3) << camera.name;
    }
}

// A plane that leans 45 degrees, as the lens pictures it: its points lie on it again, and would not by far if
// the lens were left in.
TEST(PixelRays, make_the_picture_of_a_plane_flat_again) {
    const Eigen::Vector3d normal = Eigen::Vector3d(0.6, 0.3, 1.0).normalized();
    constexpr double kPlaneM = 2.0;
    for (const std::size_t i : {0U, 1U, 3U}) {
        const PublishedCamera& camera = kTumCameras.at(i);
        const PixelRays rays(intrinsics_of(camera));
        CameraIntrinsics without_lens = intrinsics_of(camera);
        without_lens.lens = {};
        const PixelRays pinhole(without_lens);
        double off_m_max = 0.0;
        double pinhole_off_m_max = 0.0;
        for (std::uint32_t v = 0; v < 480; v += 7) {
            for (std::uint32_t u = 0; u < 640; u += 7) {
                const auto [x, y] = unproject(camera, u, v);
                const double depth_m = kPlaneM / normal.dot(Eigen::Vector3d(x, y, 1.0));
                const auto off_m = [&](RaySlope ray) {
                    return std::abs(normal.dot(depth_m * Eigen::Vector3d(ray.x, ray.y, 1.0)) - kPlaneM);
                };
                off_m_max = std::max(off_m_max, off_m(rays.at(u, v)));
                pinhole_off_m_max = std::max(pinhole_off_m_max, off_m(pinhole.at(u, v)));
            }
        }
        EXPECT_LT(off_m_max, 1e-6) << camera.name;
        EXPECT_GT(pinhole_off_m_max, 0.01) << camera.name;
    }
}

TEST(PixelRays, of_a_pinhole_go_through_its_pixels_to_the_last_bit) {
    const CameraIntrinsics camera{.width = 7, .height = 5, .fx = 3.3, .fy = 4.7, .cx = 3.1, .cy = 2.9};
    const PixelRays rays(camera);
    for (std::uint32_t v = 0; v < 5; ++v) {
        for (std::uint32_t u = 0; u < 7; ++u) {
            EXPECT_EQ(rays.at(u, v).x, (u + 0.5 - 3.1) / 3.3);
            EXPECT_EQ(rays.at(u, v).y, (v + 0.5 - 2.9) / 4.7);
        }
    }
}

// Pixels of every seventh row, one by one, against the columns and rows named.
TEST(PixelRays, columns_and_rows_leave_out_no_ray_and_few_others) {
    for (const std::size_t i : {0U, 2U, 3U}) {
        const PixelRays rays(intrinsics_of(kTumCameras.at(i)));
        for (const auto& [low, high] : {std::pair{-0.2, 0.1}, {0.3, 0.31}, {-9.0, -0.5}, {0.0, 9.0}}) {
            const PixelSpan columns = rays.columns(low, high);
            const PixelSpan rows = rays.rows(low, high);
            std::uint32_t widest = 0;
            for (std::uint32_t v = 0; v < 480; v += 7) {
                for (std::uint32_t u = 0; u < 640; ++u) {
                    const RaySlope ray = rays.at(u, v);
                    ASSERT_TRUE(ray.x < low || ray.x > high || (u >= columns.begin && u < columns.end));
                    ASSERT_TRUE(ray.y < low || ray.y > high || (v >= rows.begin && v < rows.end));
                }
                std::uint32_t inside = 0;
                for (std::uint32_t u = 0; u < 640; ++u)
                    inside += rays.at(u, v).x >= low && rays.at(u, v).x <= high ? 1U : 0U;
                widest = std::max(widest, inside);
            }
            EXPECT_LE(columns.end - columns.begin, widest + 30);
        }
        EXPECT_EQ(rays.columns(5.0, 6.0).end, 0U);
        EXPECT_EQ(rays.rows(-6.0, -5.0).end, 0U);
    }
}

}  // namespace
}  // namespace octoskin
