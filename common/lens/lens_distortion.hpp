// The distortion of a lens and its inverse: the Brown-Conrady model with the five coefficients of OpenCV and
// ROS, in their order k1 k2 p1 p2 k3.
#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <string>

namespace octoskin {

/// A ray from the camera, per unit of depth: (x, y, 1) in the optical frame (z forward, x right, y down).
struct RaySlope {
    double x = 0.0;
    double y = 0.0;
};

/// Dimensionless: the coefficients act on slopes, not on pixels. All 0: a pinhole.
struct LensDistortion {
    double k1 = 0.0, k2 = 0.0;  ///< radial, with r^2 and r^4
    double p1 = 0.0, p2 = 0.0;  ///< tangential
    double k3 = 0.0;            ///< radial, with r^6
    friend bool operator==(const LensDistortion&, const LensDistortion&) = default;
    [[nodiscard]] bool is_none() const noexcept { return *this == LensDistortion{}; }
};

/// The slope at which a pinhole camera sees the centre of the pixel in column `u`, row `v`. `camera`: focal
/// lengths fx, fy and centre cx, cy in pixels, counted from the outer edge of the first pixel.
template <class Camera>
[[nodiscard]] constexpr RaySlope picture_of(const Camera& camera, std::uint32_t u, std::uint32_t v) noexcept {
    return {(u + 0.5 - camera.cx) / camera.fx, (v + 0.5 - camera.cy) / camera.fy};
}

/// Text for a message, such as "k1 0.2624, k2 -0.9531, p1 -0.0054, p2 0.0026, k3 1.1633".
[[nodiscard]] std::string describe(const LensDistortion& lens);

/// The image point of `ray` behind this lens, as the slope at which a pinhole camera has the same image
/// point. Source: https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html "Detailed Description", x'' and y''.
[[nodiscard]] RaySlope distorted(const LensDistortion& lens, RaySlope ray) noexcept;

/// The inverse of `distorted`. Far enough from the centre the polynomial folds back and two rays share one
/// image point. Rays are therefore searched only within `radius`, where the map is proven to be one-to-one.
class LensInverse {
  public:
    explicit LensInverse(const LensDistortion& lens) noexcept;

    /// The ray that `distorted` maps to `picture` within 1e-12; empty if there is none within `radius`.
    /// Without distortion it is `picture`, bit for bit. At most 64 Newton steps, usually 3 to 6: about 0.2
    /// us.
    [[nodiscard]] std::optional<RaySlope> ray_of(RaySlope picture) const noexcept;

    /// No two rays up to this slope have the same image point. At most 4 (76 degrees off the axis).
    [[nodiscard]] double radius() const noexcept { return radius_; }

  private:
    LensDistortion lens_;
    double radius_;
};

/// Calls `visit(u, v, ray)` for the ray through each pixel's centre, row by row. `camera`: as for
/// picture_of(), with its width, height and lens. Each pixel must have a ray (asserted); the rig reader
/// rejects a camera without this. With a lens about 0.2 us a pixel.
template <class Camera, class Visit>
void for_each_pixel_ray(const Camera& camera, const Visit& visit) {
    const LensInverse inverse(camera.lens);
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (std::uint32_t u = 0; u < camera.width; ++u) {
            const std::optional<RaySlope> ray = inverse.ray_of(picture_of(camera, u, v));
            assert(ray.has_value());
            visit(u, v, *ray);
        }
    }
}

}  // namespace octoskin
