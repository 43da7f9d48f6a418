// Rays against triangles with Embree 3: the only file that includes it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hw/sim/world/solid.hpp"

namespace octoskin::sim {

/// Where a ray meets a triangle first.
struct TriangleHit {
    double t = 0.0;  ///< in lengths of the ray's direction
    std::uint32_t solid = 0;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, outwards
};

/// Embree finds the triangle in single precision, without gaps between neighbours (its robust mode); the
/// intersection with the triangle's plane is then computed in double precision, so that ranges do not depend
/// on the processor's vector width. Geometry beyond 500 m along an axis is not seen: a larger triangle is
/// clipped there. Safe to use from several threads at once.
class RayCaster {
  public:
    explicit RayCaster(const std::vector<Solid>& solids);
    RayCaster(RayCaster&&) noexcept;
    RayCaster& operator=(RayCaster&&) noexcept;
    ~RayCaster();

    /// `direction` need not be a unit vector. Only hits with t in [0, t_max].
    [[nodiscard]] std::optional<TriangleHit> cast(const Eigen::Vector3d& origin,
                                                  const Eigen::Vector3d& direction, double t_max) const;
    /// Many rays from one origin: t of each one's first hit, infinity where there is none within `t_max`.
    /// Neighbours in `directions` should point almost the same way. About 50 ns a ray.
    void cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                  std::span<double> t) const;
    /// The same with the whole hit; t is infinity where there is none.
    void cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                  std::span<TriangleHit> hits) const;
    /// As cast(), but only against one solid.
    [[nodiscard]] std::optional<TriangleHit> cast_at_solid(std::uint32_t solid, const Eigen::Vector3d& origin,
                                                           const Eigen::Vector3d& direction) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octoskin::sim
