// The shapes of a robot's links as the URDF gives them, and its joints: what fitting a body needs.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

enum class ShapeKind : std::uint8_t { mesh, box, cylinder, sphere, capsule };
[[nodiscard]] const char* name_of(ShapeKind kind) noexcept;

/// One <collision> or <visual>.
struct LinkShape {
    ShapeKind kind = ShapeKind::mesh;
    Eigen::Isometry3d T_link_shape = Eigen::Isometry3d::Identity();
    Eigen::Vector3d size = Eigen::Vector3d::Ones();  ///< sides of a box, metres; scale of a mesh
    double radius_m = 0.0;
    double length_m = 0.0;  ///< of a cylinder, and of a capsule's cylindrical part
    std::string mesh = {};  ///< the file as the URDF names it: "package://arm/link1.stl"
    int line = 0;
};

struct ShapedLink {
    std::string name;
    int line = 0;
    bool is_moving = false;  ///< a joint between the base link and it is not fixed
    std::vector<LinkShape> collisions = {};
    std::vector<LinkShape> visuals = {};  ///< those that can be read
};

/// False for a box of no size, which frames of some vendors have.
[[nodiscard]] bool is_body(const LinkShape& shape) noexcept;
/// Whether the link's body is that of its <visual>s: it moves, and no <collision> is a body.
[[nodiscard]] bool is_body_visual(const ShapedLink& link) noexcept;

struct ShapedJoint {
    std::string name;
    std::string kind;             ///< "revolute"
    std::optional<double> lower;  ///< radians or metres; none without limits
    std::optional<double> upper;
};

struct RobotShapes {
    std::string base_link;
    std::vector<ShapedLink> links;    ///< at or below the base link, in the order of the file
    std::vector<ShapedJoint> joints;  ///< likewise, those that are not fixed
};

/// `base_link`: empty for the root. Errors: those of UrdfDocument; an unknown base link; a <collision> whose
/// shape is unknown, place or size is not a finite number, or size is not positive (a box may have none);
/// such a <visual> where the body is made of it.
[[nodiscard]] Result<RobotShapes, Error> read_link_shapes(const FilePlace& urdf,
                                                          const std::string& base_link);

}  // namespace octoskin::rig
