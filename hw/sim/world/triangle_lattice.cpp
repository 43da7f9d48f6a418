#include "hw/sim/world/triangle_lattice.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "hw/sim/world/polygon_clip.hpp"

namespace octoskin::sim {
namespace {

/// Beyond this, neighbours in a row have equal coordinates in double precision.
constexpr double kStepsMax = 9e15;

double area_of(const std::vector<Eigen::Vector2d>& polygon) {
    double twice = 0.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Eigen::Vector2d& next = polygon[(i + 1) % polygon.size()];
        twice += polygon[i].x() * next.y() - polygon[i].y() * next.x();
    }
    return std::abs(twice) / 2.0;
}

}  // namespace

TriangleLattice::TriangleLattice(const std::array<Eigen::Vector3d, 3>& corners, double pitch_m)
    : pitch_m_(pitch_m) {
    assert(pitch_m > 0.0);
    const auto length = [&](std::size_t i) { return (corners[(i + 1) % 3] - corners[i]).norm(); };
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i) {
        longest = length(i) > length(longest) ? i : longest;
    }
    a_ = corners[longest];
    b_ = corners[(longest + 1) % 3];
    c_ = corners[(longest + 2) % 3];
    rows_ = std::max<std::int64_t>(1, steps_of((b_ - a_).norm()));
}

double TriangleLattice::count_near(const Eigen::AlignedBox3d& region) const {
    const Share share = share_of(padded_for_rounding(region));
    if (share.bounds.isEmpty()) return 0.0;
    const double rows = static_cast<double>(rows_);
    const double columns = (c_ - a_).norm() / pitch_m_;
    const Eigen::Vector2d border = share.bounds.sizes().cwiseProduct(Eigen::Vector2d(rows, columns));
    return share.area * rows * columns + border.sum() + 1.0;
}

Eigen::AlignedBox3d TriangleLattice::padded_for_rounding(const Eigen::AlignedBox3d& region) const {
    const double largest =
        std::max({a_.cwiseAbs().maxCoeff(), b_.cwiseAbs().maxCoeff(), c_.cwiseAbs().maxCoeff()});
    const Eigen::Vector3d slack = Eigen::Vector3d::Constant(1e-9 * (1.0 + largest));
    return {region.min() - slack, region.max() + slack};
}

TriangleLattice::Share TriangleLattice::share_of(const Eigen::AlignedBox3d& region) const {
    const auto coordinate = [&](const Eigen::Vector2d& parts, Eigen::Index axis) {
        return a_[axis] + parts.x() * (b_[axis] - a_[axis]) + parts.y() * (c_[axis] - a_[axis]);
    };
    const auto polygon =
        clipped_to(region, std::vector<Eigen::Vector2d>{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, coordinate);
    Share share{.bounds = {}, .area = area_of(polygon)};
    for (const Eigen::Vector2d& parts : polygon) share.bounds.extend(parts);
    return share;
}

TriangleLattice::Range TriangleLattice::rows_near(const Eigen::AlignedBox3d& region) const {
    const Share share = share_of(region);
    if (share.bounds.isEmpty()) return {};
    const double rows = static_cast<double>(rows_);
    return {std::max<std::int64_t>(0, static_cast<std::int64_t>(share.bounds.min().x() * rows) - 1),
            std::min(rows_, static_cast<std::int64_t>(share.bounds.max().x() * rows) + 2)};
}

TriangleLattice::Range TriangleLattice::steps_near(const Eigen::AlignedBox3d& region,
                                                   const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                                   std::int64_t count) {
    double first = 0.0;
    double last = 1.0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double way = to[axis] - from[axis];
        const double to_min = region.min()[axis] - from[axis];
        const double to_max = region.max()[axis] - from[axis];
        if (way == 0.0) {
            if (to_min > 0.0 || to_max < 0.0) return {};
            continue;
        }
        first = std::max(first, std::min(to_min / way, to_max / way));
        last = std::min(last, std::max(to_min / way, to_max / way));
    }
    const auto steps = static_cast<double>(count);
    if (first > last) return {};
    return {std::max<std::int64_t>(0, static_cast<std::int64_t>(first * steps) - 1),
            std::min(count, static_cast<std::int64_t>(last * steps) + 2)};
}

std::int64_t TriangleLattice::steps_of(double length_m) const {
    return static_cast<std::int64_t>(std::min(std::ceil(length_m / pitch_m_), kStepsMax));
}

}  // namespace octoskin::sim
