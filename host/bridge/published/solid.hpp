// Space that an object takes: the shapes of MoveIt's collision objects.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

namespace octoskin::bridge {

struct Box {
    Eigen::Vector3d half = Eigen::Vector3d::Zero();  ///< half of each edge, metres
};
struct Ball {
    double radius_m = 0.0;
};
/// About z, centred.
struct Cylinder {
    double radius_m = 0.0;
    double half_height_m = 0.0;
};
/// About z, its tip up, the centre at half its height.
struct Cone {
    double radius_m = 0.0;
    double half_height_m = 0.0;
};
/// A closed surface; what is open is a thin shell.
struct MeshSolid {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices below vertices.size()
};

struct Solid {
    std::variant<Box, Ball, Cylinder, Cone, std::shared_ptr<const MeshSolid>> shape;
    Eigen::Isometry3d T_map_solid = Eigen::Isometry3d::Identity();
};

/// Half edges of the box about the shape's origin that contains it, solid's frame, metres.
[[nodiscard]] Eigen::Vector3d half_extent(const Solid& solid);

/// Shapes or triangles that `is_within` compares with.
[[nodiscard]] std::size_t work_for(const Solid& solid) noexcept;
/// True if the point of the map frame is within `distance_m` of the solid or inside. O(1), for a mesh
/// O(triangles).
[[nodiscard]] bool is_within(const Solid& solid, const Eigen::Vector3d& p_map, double distance_m);

}  // namespace octoskin::bridge
