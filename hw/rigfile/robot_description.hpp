// The robot's collision bodies, read from its URDF, for the self-filter and the simulator. Their kinematics
// are separate: the host uses KDL, the simulator its own chain, so that each checks the other.
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

/// The treatment of a <collision> that is neither a cylinder nor a sphere.
enum class BoxRule : std::uint8_t {
    refused,  ///< by name
    fitted,   ///< a box is replaced by the capsule along its longest axis through its corners; a mesh is
              ///< refused
};

/// Every link's collision geometry as capsules, padding added. URDF has no capsule: a cylinder with a sphere
/// of its radius at each end on one link is one; a single cylinder gets round ends, a single sphere is a
/// point with a radius. Errors name file and link.
[[nodiscard]] Result<std::vector<Capsule>, Error> read_capsules(
    const FilePlace& urdf, const std::map<std::string, double>& link_padding_m,
    BoxRule boxes = BoxRule::refused);

/// A capsule that lies wholly within each collision element: for a box or a single cylinder one that touches
/// its faces, for a capsule or a sphere the element itself. None for a link with capsules fitted to a mesh
/// (fitted_urdf.hpp). Errors as read_capsules.
[[nodiscard]] Result<std::vector<Capsule>, Error> read_inner_capsules(const FilePlace& urdf,
                                                                      BoxRule boxes = BoxRule::refused);

/// The true body for a simulation: the URDF and the rig's attached capsules, without padding.
[[nodiscard]] Result<std::vector<Capsule>, Error> real_body(const Rig& rig);
/// The same with the rig's padding, for the self-filter.
[[nodiscard]] Result<std::vector<Capsule>, Error> padded_body(const Rig& rig);

/// Space that only the robot can occupy: without padding, and without the part of a capsule outside its
/// element.
[[nodiscard]] Result<std::vector<Capsule>, Error> certain_body(const Rig& rig);

}  // namespace octoskin::rig
