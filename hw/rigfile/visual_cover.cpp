#include "hw/rigfile/visual_cover.hpp"

#include <urdf_model/link.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hw/rigfile/urdf_pose.hpp"

namespace octoskin::rig {
namespace {

struct Interval {
    double from = 0.0;
    double to = 0.0;
};

/// The interval of the capsule along `direction`, measured from `p_group_zero`.
Interval extent(const Capsule& capsule, const Eigen::Vector3d& p_group_zero,
                const Eigen::Vector3d& direction) {
    const double a = direction.dot(capsule.p_link_a - p_group_zero);
    const double b = direction.dot(capsule.p_link_b - p_group_zero);
    return {std::min(a, b) - capsule.radius_m, std::max(a, b) + capsule.radius_m};
}

/// The total length of `within` that the intervals cover. Sorts the intervals.
double union_length(std::vector<Interval>& intervals, const Interval& within) {
    std::ranges::sort(intervals, {}, &Interval::from);
    double length = 0.0;
    double reached = within.from;
    for (const Interval& interval : intervals) {
        const double from = std::max(reached, interval.from);
        const double to = std::min(within.to, interval.to);
        length += std::max(0.0, to - from);
        reached = std::max(reached, std::min(to, within.to));
    }
    return length;
}

bool reaches_into(const Capsule& capsule, const VisualBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
        const Interval found =
            extent(capsule, box.T_group_box.translation(), box.T_group_box.linear().col(axis));
        if (found.to < -box.half_m[axis] || found.from > box.half_m[axis]) return false;
    }
    return true;
}

std::optional<Eigen::Vector3d> half_sides(const urdf::Geometry& geometry) {
    if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry))
        return Eigen::Vector3d(0.5 * box->dim.x, 0.5 * box->dim.y, 0.5 * box->dim.z);
    if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry))
        return Eigen::Vector3d::Constant(sphere->radius);
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry))
        return Eigen::Vector3d(cylinder->radius, cylinder->radius, 0.5 * cylinder->length);
    return std::nullopt;
}

}  // namespace

std::optional<VisualBox> visual_box(const urdf::Visual& visual, const Eigen::Isometry3d& T_group_link) {
    if (!visual.geometry) return std::nullopt;
    const auto half_m = half_sides(*visual.geometry);
    if (!half_m) return std::nullopt;
    const VisualBox box{T_group_link * urdf_isometry(visual.origin), *half_m};
    const bool is_sound = box.half_m.allFinite() && box.half_m.minCoeff() >= 0.0 &&
                          box.half_m.maxCoeff() > 0.0 && box.T_group_box.matrix().allFinite();
    return is_sound ? std::optional(box) : std::nullopt;
}

Stretch between(const Axis& from, const Axis& to) {
    const double kParallel = std::sin(std::numbers::pi / 180.0);
    const Eigen::Vector3d u = from.direction.normalized();
    const Eigen::Vector3d v = to.direction.normalized();
    const Eigen::Vector3d apart = to.p_group - from.p_group;
    const Eigen::Vector3d normal = u.cross(v);
    const double turn = normal.norm();
    if (turn < kParallel) return {from.p_group, from.p_group + apart - apart.dot(u) * u};
    const Eigen::Vector3d p_group = from.p_group + apart.cross(v).dot(normal) / (turn * turn) * u;
    return {p_group, p_group + apart.dot(normal) / (turn * turn) * normal};
}

double covered_m(const VisualBox& box, std::span<const Capsule> body) {
    Eigen::Index longest = 0;
    const double half_m = box.half_m.maxCoeff(&longest);
    std::vector<Interval> intervals;
    for (const Capsule& capsule : body) {
        if (reaches_into(capsule, box))
            intervals.push_back(
                extent(capsule, box.T_group_box.translation(), box.T_group_box.linear().col(longest)));
    }
    return union_length(intervals, {-half_m, half_m});
}

double covered_m(const Stretch& stretch, std::span<const Capsule> body) {
    const double length_m = stretch.length_m();
    if (!(length_m > 0.0)) return 0.0;
    const Eigen::Vector3d direction = (stretch.p_group_to - stretch.p_group_from) / length_m;
    std::vector<Interval> intervals;
    for (const Capsule& capsule : body) intervals.push_back(extent(capsule, stretch.p_group_from, direction));
    return union_length(intervals, {0.0, length_m});
}

}  // namespace octoskin::rig
