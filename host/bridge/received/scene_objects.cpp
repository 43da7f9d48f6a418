#include "host/bridge/received/scene_objects.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octoskin::bridge {
namespace {

using ros::moveit_msgs::CollisionObject;
using ros::shape_msgs::SolidPrimitive;

constexpr double kFarthest_m = 1000.0;

bool is_near(double value) {
    return std::abs(value) <= kFarthest_m;  // false for a NaN
}

/// Empty if it is not finite. A quaternion of zeros is one that was not set.
std::optional<Eigen::Isometry3d> pose_of(const ros::geometry_msgs::Pose& pose) {
    const auto& [p, q] = pose;
    if (!is_near(p.x) || !is_near(p.y) || !is_near(p.z)) return std::nullopt;
    const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!std::isfinite(norm)) return std::nullopt;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d(p.x, p.y, p.z);
    constexpr double kNone = 1e-6;
    if (norm > kNone) T.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
    return T;
}

/// Empty: other dimensions than the kind has, or an unsupported kind (then `is_supported` is false).
std::optional<Solid> solid_of(const SolidPrimitive& primitive, bool& is_supported) {
    const std::vector<double>& d = primitive.dimensions;
    const bool are_lengths =
        std::ranges::all_of(d, [](double length) { return length >= 0.0 && is_near(length); });
    is_supported = primitive.type >= SolidPrimitive::kBox && primitive.type <= SolidPrimitive::kCone;
    if (!are_lengths) return std::nullopt;
    if (primitive.type == SolidPrimitive::kBox && d.size() == 3)
        return Solid{Box{0.5 * Eigen::Vector3d(d[0], d[1], d[2])}};
    if (primitive.type == SolidPrimitive::kSphere && d.size() == 1) return Solid{Ball{d[0]}};
    // Height, then radius.
    if (primitive.type == SolidPrimitive::kCylinder && d.size() == 2)
        return Solid{Cylinder{d[1], 0.5 * d[0]}};
    if (primitive.type == SolidPrimitive::kCone && d.size() == 2) return Solid{Cone{d[1], 0.5 * d[0]}};
    return std::nullopt;
}

}  // namespace

void SceneObjects::add_primitive(std::vector<Solid>& shapes, const SolidPrimitive& primitive,
                                 const ros::geometry_msgs::Pose& pose) {
    bool is_supported = true;
    auto solid = solid_of(primitive, is_supported);
    const auto T = pose_of(pose);
    if (!is_supported) {
        ++counts_.unsupported;
    } else if (!solid || !T) {
        ++counts_.invalid;
    } else {
        solid->T_map_solid = *T;
        shapes.push_back(std::move(*solid));
    }
}

void SceneObjects::add_mesh(std::vector<Solid>& shapes, const ros::shape_msgs::Mesh& mesh,
                            const ros::geometry_msgs::Pose& pose) {
    MeshSolid solid;
    const auto T = pose_of(pose);
    bool is_valid =
        T.has_value() && mesh.triangles.size() <= kTrianglesMax && mesh.vertices.size() <= 3 * kTrianglesMax;
    if (!is_valid) {
        ++counts_.invalid;
        return;
    }
    for (const auto& [x, y, z] : mesh.vertices) {
        is_valid &= is_near(x) && is_near(y) && is_near(z);
        solid.vertices.emplace_back(x, y, z);
    }
    for (const ros::shape_msgs::MeshTriangle& triangle : mesh.triangles) {
        for (const std::uint32_t index : triangle.vertex_indices) is_valid &= index < mesh.vertices.size();
        solid.triangles.push_back(triangle.vertex_indices);
    }
    if (!is_valid) {
        ++counts_.invalid;
    } else {
        shapes.push_back({std::make_shared<const MeshSolid>(std::move(solid)), *T});
    }
}

std::vector<Solid> SceneObjects::shapes_of(const CollisionObject& object) {
    std::vector<Solid> shapes;
    const ros::geometry_msgs::Pose origin{{}, {0.0, 0.0, 0.0, 1.0}};
    // One pose for each shape; MoveIt also takes none at all for one shape at the object's pose.
    const auto pose_at = [&origin](const std::vector<ros::geometry_msgs::Pose>& poses, std::size_t i) {
        return i < poses.size() ? poses[i] : origin;
    };
    for (std::size_t i = 0; i < object.primitives.size(); ++i)
        add_primitive(shapes, object.primitives[i], pose_at(object.primitive_poses, i));
    for (std::size_t i = 0; i < object.meshes.size(); ++i)
        add_mesh(shapes, object.meshes[i], pose_at(object.mesh_poses, i));
    counts_.unsupported += object.planes.size();
    return shapes;
}

void SceneObjects::apply(Objects& objects, const CollisionObject& change) {
    if (change.operation == CollisionObject::kRemove) {
        if (change.id.empty()) return objects.clear();
        objects.erase(change.id);
        return;
    }
    const auto T = pose_of(change.pose);
    const auto found = objects.find(change.id);
    if (!T || (found == objects.end() && objects.size() >= kObjectsMax)) {
        ++(T ? counts_.too_many : counts_.invalid);
        return;
    }
    if (change.operation == CollisionObject::kMove) {
        if (found == objects.end()) return;
        found->second.frame = change.header.frame_id;
        found->second.T_frame_object = *T;
        return;
    }
    std::vector<Solid> shapes = shapes_of(change);
    if (shapes_in(world_) + shapes_in(held_) + shapes.size() > kShapesMax) {
        ++counts_.too_many;
        return;
    }
    if (change.operation == CollisionObject::kAppend && found != objects.end()) {
        // In the object's frame, whatever frame the difference names.
        found->second.shapes.insert(found->second.shapes.end(), shapes.begin(), shapes.end());
        return;
    }
    objects[change.id] = {change.header.frame_id, *T, std::move(shapes)};
}

std::size_t SceneObjects::shapes_in(const Objects& objects) noexcept {
    std::size_t shapes = 0;
    for (const auto& [id, object] : objects) shapes += object.shapes.size();
    return shapes;
}

void SceneObjects::hold(const ros::moveit_msgs::AttachedCollisionObject& change) {
    CollisionObject object = change.object;
    if (object.header.frame_id.empty()) object.header.frame_id = change.link_name;
    const bool is_removal = object.operation == CollisionObject::kRemove;
    const bool has_shapes = !object.primitives.empty() || !object.meshes.empty();
    const auto in_world = world_.find(object.id);
    // An object of the scene is taken as it is, where it is.
    if (!is_removal && !has_shapes && in_world != world_.end()) {
        held_[object.id] = in_world->second;
        world_.erase(in_world);
        return;
    }
    apply(held_, object);
    if (!is_removal) world_.erase(object.id);
}

void SceneObjects::take(const ros::moveit_msgs::PlanningScene& scene) {
    ++counts_.scenes;
    const bool has_changes =
        !scene.world.collision_objects.empty() || !scene.robot_state.attached_collision_objects.empty();
    if (has_changes || (!scene.robot_state.is_diff && !held_.empty())) ++version_;
    if (!scene.is_diff) clear();
    if (!scene.robot_state.is_diff) held_.clear();
    for (const CollisionObject& change : scene.world.collision_objects) apply(world_, change);
    for (const auto& change : scene.robot_state.attached_collision_objects) hold(change);
}

SceneObjects::Placed SceneObjects::placed(const FramePose& T_map_frame) const {
    Placed placed;
    for (const Objects* objects : {&world_, &held_}) {
        for (const auto& [id, object] : *objects) {
            const auto T_map = T_map_frame(object.frame);
            if (!T_map) {
                placed.unplaced.push_back(object.frame);
                continue;
            }
            for (Solid solid : object.shapes) {
                solid.T_map_solid = *T_map * object.T_frame_object * solid.T_map_solid;
                placed.solids.push_back(std::move(solid));
            }
        }
    }
    return placed;
}

}  // namespace octoskin::bridge
