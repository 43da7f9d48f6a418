// A view along an axis, as a panel of an SVG picture.
#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <string>

#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// The axes that a view shows to the right and upwards, and how it is called: "x, z".
struct ViewAxes {
    Eigen::Index right;
    Eigen::Index up;
    const char* name;
};
inline constexpr std::array kThreeViews{ViewAxes{0, 2, "x, z"}, ViewAxes{1, 2, "y, z"},
                                        ViewAxes{0, 1, "x, y"}};

/// A square panel that shows a box, with its upper left corner at (x_px, y_px).
class SvgView {
  public:
    SvgView(const Eigen::AlignedBox3d& box, const ViewAxes& axes, double side_px, double x_px, double y_px)
        : axes_(axes),
          px_per_m_((side_px - 2.0 * kEdge_px) / box.sizes().maxCoeff()),
          middle_(box.center()),
          x_(x_px + 0.5 * side_px),
          y_(y_px + 0.5 * side_px) {}

    /// "12.3,45.6"
    [[nodiscard]] std::string at(const Eigen::Vector3d& point) const {
        return fmt::format("{:.1f},{:.1f}", x_ + px_per_m_ * (point[axes_.right] - middle_[axes_.right]),
                           y_ - px_per_m_ * (point[axes_.up] - middle_[axes_.up]));
    }
    /// The data of a path along the points.
    [[nodiscard]] std::string path(std::span<const Eigen::Vector3d> points, bool is_closed) const {
        std::string data;
        for (const Eigen::Vector3d& point : points) data += (data.empty() ? "M" : "L") + at(point);
        return data + (is_closed ? "Z" : "");
    }
    /// Seen from far away, a capsule is a line with round ends: a path of this class, whose line caps have to
    /// be round.
    [[nodiscard]] std::string capsule(const char* css_class, const PosedCapsule& capsule) const {
        return fmt::format("<path class=\"{}\" stroke-width=\"{:.1f}\" d=\"M{}L{}\"/>\n", css_class,
                           2.0 * capsule.radius_m * px_per_m_, at(capsule.p_a), at(capsule.p_b));
    }

  private:
    static constexpr double kEdge_px = 8.0;

    ViewAxes axes_;
    double px_per_m_;
    Eigen::Vector3d middle_;
    double x_;
    double y_;
};

}  // namespace octoskin
