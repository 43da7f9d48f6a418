// The robot's collision bodies, read from its URDF: what the self-filter and the simulator share. Kinematics
// they do not share: the host has KDL, the simulator its own chain, so that each checks the other.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
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

/// Every link's collision geometry as capsules, padding added. URDF has no capsule: a cylinder with a sphere
/// of its radius at each end on one link is one; a lone cylinder is padded to one, a lone sphere is a point
/// with a radius, and a box or mesh is refused by name. Errors name file and link.
[[nodiscard]] Result<std::vector<Capsule>, RigError> read_capsules(
    const std::filesystem::path& urdf, const std::map<std::string, double>& link_padding_m);

}  // namespace octoskin::rig
