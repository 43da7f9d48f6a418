// Seeded rays, poses and depth images for the oracle tests: ordinary ones, and those that sit where rounding
// decides.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin::property {

class RandomGeometry {
  public:
    RandomGeometry(unsigned seed, double resolution_m) : random_(seed), resolution_m_(resolution_m) {}

    /// One coordinate within `reach_m` of the origin: anywhere, on a face, at a centre, or a rounding error
    /// beside a face.
    float coordinate(double reach_m) {
        const double anywhere = uniform(-reach_m, reach_m);
        const double face = std::round(anywhere / resolution_m_) * resolution_m_;
        switch (pick(8)) {
            case 0:
                return static_cast<float>(face);
            case 1:
                return static_cast<float>(face + 0.5 * resolution_m_);
            case 2:
                return std::nextafter(static_cast<float>(face), pick(2) == 0 ? -1e9F : 1e9F);
            case 3:
                return 0.0F;
            default:
                return static_cast<float>(anywhere);
        }
    }

    Eigen::Vector3f point(double reach_m) {
        return {coordinate(reach_m), coordinate(reach_m), coordinate(reach_m)};
    }

    /// An end for a ray from `origin`: anywhere, parallel to an axis or a plane, very near, or along a
    /// diagonal.
    Eigen::Vector3f end_from(const Eigen::Vector3f& origin, double reach_m) {
        Eigen::Vector3f end = point(reach_m);
        switch (pick(8)) {
            case 0: {  // parallel to an axis
                const int kept = axis();
                const float coordinate_on_it = end[kept];
                end = origin;
                end[kept] = coordinate_on_it;
                break;
            }
            case 1: {  // parallel to a plane
                const int flat = axis();
                end[flat] = origin[flat];
                break;
            }
            case 2: {  // through corner after corner
                const float length = coordinate(reach_m);
                end = origin + Eigen::Vector3f(sign() * length, sign() * length, sign() * length);
                break;
            }
            case 3:  // no longer than a few voxels
                end = origin + (end - origin) * static_cast<float>(resolution_m_ / reach_m);
                break;
            case 4:
                end = pick(4) == 0 ? origin : end;
                break;
            default:
                break;
        }
        return end;
    }

    /// A camera: anywhere, on a face, edge or corner, turned freely or by quarter turns.
    Eigen::Isometry3d camera_pose() {
        Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
        T_map_camera.translation() = point(3.0).cast<double>();
        if (pick(3) == 0) {
            for (int i = 0; i < 3; ++i) {
                T_map_camera.rotate(
                    Eigen::AngleAxisd(0.5 * M_PI * static_cast<double>(pick(4)), Eigen::Vector3d::Unit(i)));
            }
        } else {
            const Eigen::Quaterniond turn(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
            T_map_camera.rotate(turn.normalized());
        }
        return T_map_camera;
    }

    /// Smooth surfaces with steps, noise, holes and now and then a value far away or at the very front.
    DepthImage depth_image(std::uint32_t width, std::uint32_t height) {
        DepthImage image{.width = width, .height = height, .depth_m = {}};
        const double base_m = uniform(0.5, 3.0);
        const double slope = uniform(-0.02, 0.02);
        const double noise_m = pick(2) == 0 ? 0.0 : 0.03;
        for (std::uint32_t i = 0; i < width * height; ++i) {
            double depth_m =
                base_m + slope * (i % width) + ((i / width / 11) % 3) * 0.4 + noise_m * uniform(-2, 2);
            if (pick(50) == 0) depth_m = uniform(0.001, 8.0);
            const bool is_hole = pick(10) == 0 || depth_m <= 0.0;
            image.depth_m.push_back(is_hole ? std::numeric_limits<float>::quiet_NaN()
                                            : static_cast<float>(depth_m));
        }
        return image;
    }

    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    unsigned pick(unsigned count) { return std::uniform_int_distribution<unsigned>(0, count - 1)(random_); }

  private:
    int axis() { return static_cast<int>(pick(3)); }
    float sign() { return pick(2) == 0 ? -1.0F : 1.0F; }

    std::mt19937 random_;
    double resolution_m_;
};

}  // namespace octoskin::property
