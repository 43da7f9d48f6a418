// The part of a line along x that a capsule contains.
#pragma once

#include <algorithm>
#include <cmath>

#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// From one x to another; empty if `from` is not less than `to`.
struct RowInterval {
    double from = 1.0;
    double to = 0.0;
    [[nodiscard]] bool is_empty() const noexcept { return !(from < to); }
};

/// Two balls and the cylinder between them, each of which meets a line in one interval.
class RowCut {
  public:
    explicit RowCut(const PosedCapsule& capsule)
        : a_(capsule.p_a),
          b_(capsule.p_b),
          axis_(b_ - a_),
          length2_(axis_.squaredNorm()),
          radius2_(capsule.radius_m * capsule.radius_m) {
        if (!(length2_ > 1e-18)) return;
        slope_ = axis_.x() / length2_;
        quadratic_ = 1.0 - axis_.x() * slope_;
    }

    /// At these y and z, in the capsule's frame.
    [[nodiscard]] RowInterval operator()(double y, double z) const {
        RowInterval interval;
        add_ball(a_, y, z, interval);
        if (!(length2_ > 1e-18)) return interval;
        add_ball(b_, y, z, interval);
        add_wall(y - a_.y(), z - a_.z(), interval);
        return interval;
    }

  private:
    static void extend(double low, double high, RowInterval& interval) {
        if (!(low <= high)) return;
        const bool is_first = interval.from > interval.to;
        interval.from = is_first ? low : std::min(interval.from, low);
        interval.to = is_first ? high : std::max(interval.to, high);
    }

    void add_ball(const Eigen::Vector3d& centre, double y, double z, RowInterval& interval) const {
        const double dy = y - centre.y();
        const double dz = z - centre.z();
        const double square = radius2_ - dy * dy - dz * dz;
        if (square < 0.0) return;
        const double half = std::sqrt(square);
        extend(centre.x() - half, centre.x() + half, interval);
    }

    /// `y` and `z` from the end a.
    void add_wall(double y, double z, RowInterval& interval) const {
        const double along =
            y * axis_.y() + z * axis_.z();  // of the point at x = a.x, times the axis' length
        const double across2 = y * y + z * z - along * along / length2_ - radius2_;
        double low = -1e9;
        double high = 1e9;
        if (quadratic_ > 1e-12) {
            const double half_linear = -along * slope_;
            const double root2 = half_linear * half_linear - quadratic_ * across2;
            if (root2 < 0.0) return;
            const double root = std::sqrt(root2);
            low = (-half_linear - root) / quadratic_;
            high = (-half_linear + root) / quadratic_;
        } else if (across2 > 0.0) {
            return;
        }
        if (std::abs(axis_.x()) > 1e-12) {
            const double at_a = -along / axis_.x();
            const double at_b = (length2_ - along) / axis_.x();
            low = std::max(low, std::min(at_a, at_b));
            high = std::min(high, std::max(at_a, at_b));
        } else if (along < 0.0 || along > length2_) {
            return;
        }
        extend(a_.x() + low, a_.x() + high, interval);
    }

    Eigen::Vector3d a_;
    Eigen::Vector3d b_;
    Eigen::Vector3d axis_;
    double length2_ = 0.0;
    double radius2_ = 0.0;
    double slope_ = 0.0;
    double quadratic_ = 0.0;
};

}  // namespace octoskin
