// The robot's collision bodies, read from its URDF: what the self-filter and the simulator share. Kinematics
// they do not share: the host has KDL, the simulator its own chain, so that each checks the other.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// All points within `radius_m` of the segment from p_link_a to p_link_b (equal ends: a sphere).
struct Capsule {
    std::string link;
    Eigen::Vector3d p_link_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_link_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
};

/// What stands in for a <collision> of the URDF that is neither a cylinder nor a sphere.
enum class BoxRule : std::uint8_t {
    refused,  ///< by name
    fitted,   ///< a box is the capsule about its longest side that its corners lie on; a mesh is refused
};

/// Every link's collision geometry as capsules, padding added. URDF has no capsule: a cylinder with a sphere
/// of its radius at each end on one link is one; a lone cylinder is padded to one, a lone sphere is a point
/// with a radius. Errors name file and link.
[[nodiscard]] Result<std::vector<Capsule>, RigError> read_capsules(
    const FilePlace& urdf, const std::map<std::string, double>& link_padding_m,
    BoxRule boxes = BoxRule::refused);

/// What lies wholly within each collision element: of a box and of a lone cylinder a capsule that reaches its
/// faces, of a capsule and a sphere all of it. Errors as read_capsules.
[[nodiscard]] Result<std::vector<Capsule>, RigError> read_inner_capsules(const FilePlace& urdf,
                                                                         BoxRule boxes = BoxRule::refused);

/// The robot as it is, by its URDF and what the rig attaches to it: without padding. For a simulation.
[[nodiscard]] Result<std::vector<Capsule>, RigError> real_body(const Rig& rig);
/// The same with the rig's padding: what the self-filter takes for the robot.
[[nodiscard]] Result<std::vector<Capsule>, RigError> padded_body(const Rig& rig);

/// Where nothing can be but the robot: no padding, and nothing of what a capsule has more than its element.
[[nodiscard]] Result<std::vector<Capsule>, RigError> certain_body(const Rig& rig);

}  // namespace octoskin::rig
