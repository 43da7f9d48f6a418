// Points of a triangle's surface on rows that depend only on its corners: a region selects points and does
// not move them.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace octoskin::sim {

/// Rows parallel to the side ac, from ab to bc. If ab is the longest side, neighbours are at most one pitch
/// apart within a row, between rows and along each side.
class TriangleLattice {
  public:
    /// Metres.
    TriangleLattice(const std::array<Eigen::Vector3d, 3>& corners, double pitch_m);

    /// Calls `visit(point)` for every point within the region, and possibly for some outside. O(points
    /// visited + rows that meet the region), independent of the triangle's size.
    template <class Visit>
    void for_each_near(const Eigen::AlignedBox3d& region, const Visit& visit) const {
        const Eigen::AlignedBox3d padded = padded_for_rounding(region);
        const Range rows = rows_near(padded);
        for (std::int64_t row = rows.first; row <= rows.last; ++row) {
            const double part = static_cast<double>(row) / static_cast<double>(rows_);
            const Eigen::Vector3d from = a_ + part * (b_ - a_);
            const Eigen::Vector3d to = c_ + part * (b_ - c_);
            const std::int64_t count = steps_of((to - from).norm());
            const Range steps = steps_near(padded, from, to, count);
            for (std::int64_t step = steps.first; step <= steps.last; ++step) {
                visit(count == 0 ? from
                                 : Eigen::Vector3d(from + (to - from) * (static_cast<double>(step) /
                                                                         static_cast<double>(count))));
            }
        }
    }
    /// About how many points for_each_near() visits; O(1).
    [[nodiscard]] double count_near(const Eigen::AlignedBox3d& region) const;

  private:
    struct Range {
        std::int64_t first = 0;
        std::int64_t last = -1;
    };
    /// The clipped part of a triangle, as fractions of ab and of ac.
    struct Share {
        Eigen::AlignedBox2d bounds;
        double area = 0.0;  ///< 0.5 for the whole triangle
    };
    [[nodiscard]] Eigen::AlignedBox3d padded_for_rounding(const Eigen::AlignedBox3d& region) const;
    [[nodiscard]] Share share_of(const Eigen::AlignedBox3d& region) const;
    [[nodiscard]] Range rows_near(const Eigen::AlignedBox3d& region) const;
    [[nodiscard]] static Range steps_near(const Eigen::AlignedBox3d& region, const Eigen::Vector3d& from,
                                          const Eigen::Vector3d& to, std::int64_t count);
    [[nodiscard]] std::int64_t steps_of(double length_m) const;

    Eigen::Vector3d a_;
    Eigen::Vector3d b_;
    Eigen::Vector3d c_;
    double pitch_m_;
    std::int64_t rows_;
};

}  // namespace octoskin::sim
