// A picture's geometry in Embree. The only file of the report that includes Embree.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>

#include "host/lab/report/geometry.hpp"

namespace octoskin::report {

enum class Shape : std::uint8_t { face, triangle, body, line };

/// The first intersection of a ray with the geometry.
struct SceneHit {
    float range_m = 0.0F;
    Shape shape = Shape::face;
    std::uint32_t index = 0;  ///< in the `Geometry`'s list of that shape
    /// On a face: shares of the way from corner 0 to corner 1, and from corner 0 to corner 3.
    float u = 0.0F;
    float v = 0.0F;
    Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< unit, towards the ray's origin
};

/// Queries are safe from several threads at once.
class RayScene {
  public:
    explicit RayScene(const Geometry& geometry);
    RayScene(RayScene&&) noexcept;
    RayScene& operator=(RayScene&&) noexcept;
    ~RayScene();

    /// Lines included. About 0.2 us.
    [[nodiscard]] std::optional<SceneHit> first_hit(const Eigen::Vector3f& origin,
                                                    const Eigen::Vector3f& direction) const;
    /// Distance to the first obstacle for light within `range_max_m`; empty if there is none. Lines are not
    /// obstacles.
    [[nodiscard]] std::optional<float> obstacle(const Eigen::Vector3f& origin,
                                                const Eigen::Vector3f& direction, float range_max_m) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octoskin::report
