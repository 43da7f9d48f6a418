// The convex hull of points, as half-spaces and as a volume.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "host/core/body_fit/fit_work.hpp"
#include "host/core/body_fit/row_cut.hpp"

namespace octoskin {

class ConvexHull {
  public:
    /// Points within this distance of a plane are treated as on it, metres.
    static constexpr double kTolerance_m = 1e-6;

    /// Quickhull (Barber 1996) of points that are moved by up to 1 micrometre, so that no four lie in a
    /// plane: the moves are the same in each run. Points up to `flat_m` beyond the hull so far are left out:
    /// on a smooth surface of many points nearly all. None if all points are within 10 micrometres of a
    /// plane, and if it takes more than is left of `work`: a step for each point and face that are compared.
    /// O(n log n) for points in no special order.
    [[nodiscard]] static std::optional<ConvexHull> around(std::span<const Eigen::Vector3d> points,
                                                          double flat_m = 0.0, FitWork* work = nullptr);

    [[nodiscard]] double volume_m3() const noexcept { return volume_m3_; }
    /// True up to kTolerance_m outside. O(faces).
    [[nodiscard]] bool contains(const Eigen::Vector3d& point) const noexcept;
    /// The part of the line along x at these y and z. O(faces).
    [[nodiscard]] RowInterval row(double y, double z) const noexcept;
    [[nodiscard]] std::size_t face_count() const noexcept { return planes_.size(); }

  private:
    struct Plane {
        Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outwards, of length 1
        double offset_m = 0.0;                              ///< normal * point <= offset inside
    };
    friend class HullBuilder;
    std::vector<Plane> planes_;
    double volume_m3_ = 0.0;
};

}  // namespace octoskin
