// The arm's body at one instant for ray-casting: its collision capsules in the base frame.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"

namespace octoskin::sim {

/// All points within `radius_m` of the segment from p_base_a to p_base_b.
struct BodyCapsule {
    Eigen::Vector3d p_base_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_base_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// The capsules at the links' poses. Leaves out links in `ignored` and links that the arm does not have.
[[nodiscard]] std::vector<BodyCapsule> posed_body(const std::vector<rig::Capsule>& capsules,
                                                  const Arm::LinkPoses& poses,
                                                  const std::vector<std::string>& ignored = {});

/// Where a ray enters a capsule, in lengths of `direction` (any length but 0): 0 if the origin is inside,
/// empty if it misses or the capsule lies behind. Solved in closed form.
[[nodiscard]] std::optional<double> cast_capsule(const BodyCapsule& capsule, const Eigen::Vector3d& origin,
                                                 const Eigen::Vector3d& direction);

/// The outward unit normal of a capsule at a point of its surface.
[[nodiscard]] Eigen::Vector3d outward_normal(const BodyCapsule& capsule, const Eigen::Vector3d& p_base);

/// The nearest of cast_capsule() over a body.
[[nodiscard]] std::optional<double> cast_body(const std::vector<BodyCapsule>& body,
                                              const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& direction);

/// The distance along a ray (direction: unit vector) to the nearest capsule of a posed robot; 0 if the origin
/// is inside one. Links in `ignored` do not count.
[[nodiscard]] std::optional<double> cast_robot(const std::vector<rig::Capsule>& capsules,
                                               const Arm::LinkPoses& poses, const Eigen::Vector3d& origin,
                                               const Eigen::Vector3d& direction,
                                               const std::vector<std::string>& ignored = {});

}  // namespace octoskin::sim
