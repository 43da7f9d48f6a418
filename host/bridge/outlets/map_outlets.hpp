// The map on its topics: made only for topics that have a reader, when the map changes, at each topic's rate.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "host/bridge/outlets/outlet.hpp"
#include "host/bridge/published/binary_octree.hpp"
#include "host/bridge/published/map_view.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/io/watch/watched_map.hpp"

namespace octoskin::bridge {

struct MapTopics {
    std::string prefix = "/octoskin";
    std::string scene = "/planning_scene";
    std::string map_frame = "octoskin_map";
    double object_padding_m = 0.01;
    /// Unknown space in it is an obstacle in the planning scene; map frame, metres.
    std::optional<Eigen::AlignedBox3d> unknown_box = {};
    double own_space_m = 0.1;
};

class MapOutlets {
  public:
    [[nodiscard]] static Result<MapOutlets, Error> open(TopicSink& sink, MapTopics topics);

    void on_robot(const RobotFacts& robot);
    void on_map(const watch::WatchedMap& map);
    /// Nothing is published until the next whole map.
    void on_lost() { map_.reset(); }
    /// Objects of the planner that are left out, and the robot's body; both in the map frame. With another
    /// `version` of the objects, the map is sent again.
    void change_surroundings(std::vector<Solid> objects, std::uint64_t version,
                             std::vector<PosedCapsule> body);

    /// Whether `attend` has anything to send.
    [[nodiscard]] bool is_due(HostTime now) const;
    /// Sends what is due. O(voxels) for each message; binary octrees: O(their bytes and the changes).
    void attend(HostTime now, WallTime wall);

    /// Without a reader nothing is sent, so the message that a late reader would get is of an old map: it
    /// gets none, and then the map as it is.
    void forget_unread();

    [[nodiscard]] std::vector<const Outlet*> outlets() const;
    /// Objects that are too large to be left out.
    [[nodiscard]] std::size_t objects_left_in() const noexcept { return objects_left_in_; }

  private:
    enum class Form : std::uint8_t { scene, binary, full, cloud, markers, grid };
    struct Topic {
        Form form;
        Outlet outlet;
        Pace pace;
        Pace::Sent sent = {};
    };
    explicit MapOutlets(MapTopics topics) : options_(std::move(topics)) {}
    [[nodiscard]] bool is_due(const Topic& topic, HostTime now) const;
    [[nodiscard]] FusedMap view();
    void send(Topic& topic, const FusedMap& view, WallTime wall);
    [[nodiscard]] const BinaryOctree& octree_of(const FusedMap& view);
    [[nodiscard]] const BinaryOctree& scene_octree_of(const FusedMap& view);

    MapTopics options_;
    std::vector<Topic> topics_;
    std::optional<watch::WatchedMap> map_;
    std::uint64_t generation_ = 0;   ///< counts maps that differ
    std::uint64_t obstacle_in_ = 0;  ///< the newest generation in which free space became occupied
    std::string root_link_;
    Eigen::Isometry3d T_root_map_ = Eigen::Isometry3d::Identity();
    std::vector<Solid> objects_;
    std::uint64_t objects_version_ = 0;
    std::vector<PosedCapsule> body_;
    std::size_t objects_left_in_ = 0;
    BinaryOctree octree_;
    BinaryOctree scene_octree_;  ///< with unknown space as obstacles, if it is so in the planning scene
};

}  // namespace octoskin::bridge
