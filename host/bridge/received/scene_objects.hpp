// The objects of a planner: those of its scene, and those that the robot holds. MoveIt's rules of a scene and
// its differences.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/bridge/published/solid.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

struct SceneObjectCounts {
    std::uint64_t scenes = 0;
    std::uint64_t malformed = 0;  ///< not the encoding of a PlanningScene
    std::uint64_t invalid = 0;    ///< shapes that are not finite, negative, too large, or without a pose each
    std::uint64_t unsupported = 0;  ///< shapes that are planes or prisms
    std::uint64_t too_many = 0;     ///< objects beyond kObjectsMax, or shapes beyond kShapesMax
};

/// The pose of a frame in the map; empty: the frame is not known.
using FramePose = std::function<std::optional<Eigen::Isometry3d>(const std::string& frame)>;

class SceneObjects {
  public:
    static constexpr std::size_t kObjectsMax = 1024;
    static constexpr std::size_t kTrianglesMax = 20'000;  ///< of a mesh
    static constexpr std::size_t kShapesMax = 4096;       ///< of all objects

    /// A whole scene replaces all objects, a difference changes those that it names.
    void take(const ros::moveit_msgs::PlanningScene& scene);
    void note_malformed() noexcept { ++counts_.malformed; }
    /// No planner is there any more: its objects are gone.
    void clear() {
        if (!world_.empty() || !held_.empty()) ++version_;
        world_.clear();
        held_.clear();
    }
    /// Another number after each change.
    [[nodiscard]] std::uint64_t version() const noexcept { return version_; }

    /// All shapes in the map frame. `unplaced`: the frames that are not known.
    struct Placed {
        std::vector<Solid> solids;
        std::vector<std::string> unplaced;
    };
    [[nodiscard]] Placed placed(const FramePose& T_map_frame) const;

    [[nodiscard]] std::size_t in_world() const noexcept { return world_.size(); }
    [[nodiscard]] std::size_t held() const noexcept { return held_.size(); }
    [[nodiscard]] const SceneObjectCounts& counts() const noexcept { return counts_; }

  private:
    struct Object {
        std::string frame;
        Eigen::Isometry3d T_frame_object = Eigen::Isometry3d::Identity();
        std::vector<Solid> shapes;  ///< poses relative to the object
    };
    using Objects = std::map<std::string, Object>;
    [[nodiscard]] static std::size_t shapes_in(const Objects& objects) noexcept;
    void apply(Objects& objects, const ros::moveit_msgs::CollisionObject& change);
    void hold(const ros::moveit_msgs::AttachedCollisionObject& change);
    [[nodiscard]] std::vector<Solid> shapes_of(const ros::moveit_msgs::CollisionObject& object);
    void add_mesh(std::vector<Solid>& shapes, const ros::shape_msgs::Mesh& mesh,
                  const ros::geometry_msgs::Pose& pose);
    void add_primitive(std::vector<Solid>& shapes, const ros::shape_msgs::SolidPrimitive& primitive,
                       const ros::geometry_msgs::Pose& pose);

    Objects world_;
    Objects held_;
    SceneObjectCounts counts_;
    std::uint64_t version_ = 0;
};

}  // namespace octoskin::bridge
