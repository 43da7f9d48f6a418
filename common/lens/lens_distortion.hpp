// How a lens bends rays, and back: the model of Brown and Conrady with the five coefficients that OpenCV and
// ROS write, in their order k1 k2 p1 p2 k3.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace octoskin {

/// A ray from the camera, per unit of depth: (x, y, 1) in the optical frame (z forward, x right, y down).
struct RaySlope {
    double x = 0.0;
    double y = 0.0;
};

/// Dimensionless: they act on slopes, not on pixels. All 0: a pinhole.
struct LensDistortion {
    double k1 = 0.0, k2 = 0.0;  ///< radial, with r^2 and r^4
    double p1 = 0.0, p2 = 0.0;  ///< tangential
    double k3 = 0.0;            ///< radial, with r^6
    friend bool operator==(const LensDistortion&, const LensDistortion&) = default;
    [[nodiscard]] bool is_none() const noexcept { return *this == LensDistortion{}; }
};

/// Where a pinhole sees the centre of column `u`, row `v`. `camera`: focal lengths fx, fy and centre cx, cy
/// in pixels, counted from the outer edge of the first.
template <class Camera>
[[nodiscard]] constexpr RaySlope picture_of(const Camera& camera, std::uint32_t u, std::uint32_t v) noexcept {
    return {(u + 0.5 - camera.cx) / camera.fx, (v + 0.5 - camera.cy) / camera.fy};
}

/// "k1 0.2624, k2 -0.9531, p1 -0.0054, p2 0.0026, k3 1.1633": for a message.
[[nodiscard]] std::string describe(const LensDistortion& lens);

/// Where a pinhole would have to see the ray `ray` for its picture to be that of this lens. Source:
/// https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html "Detailed Description", x'' and y''.
[[nodiscard]] RaySlope distorted(const LensDistortion& lens, RaySlope ray) noexcept;

/// The way back. A polynomial turns back on itself far enough from the centre, and there two rays have one
/// picture; so rays are looked for only within `radius`, where it is proven that they have not.
class LensInverse {
  public:
    explicit LensInverse(const LensDistortion& lens) noexcept;

    /// The ray that `distorted` sends to `picture` within 1e-12; empty if none within `radius` is. The
    /// picture itself, to the last bit, if the lens is none. At most 64 Newton steps, 3 to 6 as a rule: about
    /// 0.2 us.
    [[nodiscard]] std::optional<RaySlope> ray_of(RaySlope picture) const noexcept;

    /// No two rays up to this slope, at most 4 (76 degrees off the axis), have the same picture.
    [[nodiscard]] double radius() const noexcept { return radius_; }

  private:
    LensDistortion lens_;
    double radius_;
};

}  // namespace octoskin
