#include "host/bridge/outlets/map_outlets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/bridge/published/map_messages.hpp"
#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {
namespace {

using namespace std::chrono_literals;

/// Whether a voxel is occupied that was not. An unknown one, a NaN, is below any threshold.
bool has_new_obstacle(const BrickView& now, float now_from, const BrickView& before, float before_from) {
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
        if (now.at(cell) >= now_from && !(before.at(cell) >= before_from)) return true;
    return false;
}

/// How the bricks of two maps of one daemon differ.
struct Difference {
    bool is_any = false;
    bool has_new_obstacle = false;  ///< what was free or unknown is occupied
};
Difference difference(const watch::WatchedMap& now, const watch::WatchedMap& before) {
    Difference found;
    now.log_odds().for_each_difference(before.log_odds(), [&](MortonCode brick) {
        found.is_any = true;
        found.has_new_obstacle =
            found.has_new_obstacle || has_new_obstacle(now.log_odds().find(brick), now.occupied_from(),
                                                       before.log_odds().find(brick), before.occupied_from());
    });
    return found;
}

/// True if a point of a solid, within a metre of its origin, has moved by more than this.
bool have_moved(const std::vector<Solid>& now, const std::vector<Solid>& before, double distance_m) {
    if (now.size() != before.size()) return true;
    for (std::size_t i = 0; i < now.size(); ++i)
        if ((now[i].T_map_solid.matrix() - before[i].T_map_solid.matrix()).norm() > distance_m) return true;
    return false;
}

}  // namespace

Result<MapOutlets, Error> MapOutlets::open(TopicSink& sink, MapTopics topics) {
    MapOutlets made(std::move(topics));
    const std::string& prefix = made.options_.prefix;
    const auto add = [&](Form form, Result<Outlet, Error> outlet, const Pace& pace) -> Status<Error> {
        if (!outlet) return unexpected(outlet.error());
        made.topics_.push_back({form, std::move(outlet).value(), pace});
        return Done{};
    };
    using ros::octomap_msgs::Octomap;
    const std::array added = {
        add(Form::scene,
            Outlet::open<ros::moveit_msgs::PlanningScene>(sink, made.options_.scene, kLastMessage),
            {500ms, 100ms, 2s}),
        add(Form::binary, Outlet::open<Octomap>(sink, prefix + "/octomap_binary", kLastMessage),
            {100ms, 100ms}),
        add(Form::full, Outlet::open<Octomap>(sink, prefix + "/octomap_full", kLastMessage), {1s, 1s}),
        add(Form::cloud,
            Outlet::open<ros::sensor_msgs::PointCloud2>(sink, prefix + "/occupied", kLastMessage),
            {500ms, 500ms}),
        add(Form::markers,
            Outlet::open<ros::visualization_msgs::MarkerArray>(sink, prefix + "/occupied_cells_vis_array",
                                                               kLastMessage),
            {1s, 1s}),
        add(Form::grid,
            Outlet::open<ros::nav_msgs::OccupancyGrid>(sink, prefix + "/projected_map", kLastMessage),
            {1s, 1s})};
    for (const auto& one : added)
        if (!one) return unexpected(one.error());
    return made;
}

void MapOutlets::on_robot(const RobotFacts& robot) {
    root_link_ = robot.root_link;
    T_root_map_ = robot.T_root_map;
    ++generation_;
}

void MapOutlets::on_map(const watch::WatchedMap& map) {
    const Difference found = map_ && map_->resolution_m() == map.resolution_m()
                                 ? difference(map, *map_)
                                 : Difference{.is_any = true, .has_new_obstacle = true};
    map_ = map;
    if (found.is_any) ++generation_;
    if (found.has_new_obstacle) obstacle_in_ = generation_;
}

void MapOutlets::change_surroundings(std::vector<Solid> objects, std::uint64_t version,
                                     std::vector<PosedCapsule> body) {
    const double voxel_m = map_ ? map_->resolution_m() : 0.0;
    if (version != objects_version_ || have_moved(objects, objects_, 0.25 * voxel_m)) {
        ++generation_;
        objects_ = std::move(objects);
    }
    objects_version_ = version;
    body_ = std::move(body);
}

FusedMap MapOutlets::view() {
    FusedMap map = map_->map();
    objects_left_in_ = 0;
    if (objects_.empty()) return map;
    CutMap cut = without(map, objects_, options_.object_padding_m);
    objects_left_in_ = cut.solids_left_in;
    return std::move(cut.map);
}

const BinaryOctree& MapOutlets::octree_of(const FusedMap& view) {
    octree_.update(view.layers().log_odds, view.config().log_odds_occupied);
    return octree_;
}

const BinaryOctree& MapOutlets::scene_octree_of(const FusedMap& view) {
    if (!options_.unknown_box) return octree_of(view);
    const FusedMap scene = with_unknown_occupied(view, *options_.unknown_box, body_, options_.own_space_m);
    scene_octree_.update(scene.layers().log_odds, scene.config().log_odds_occupied);
    return scene_octree_;
}

void MapOutlets::send(Topic& topic, const FusedMap& view, WallTime wall) {
    const ros::std_msgs::Header in_map = ros_header(wall, options_.map_frame);
    switch (topic.form) {
        case Form::scene: {
            const ros::std_msgs::Header in_root = ros_header(wall, root_link_);
            return topic.outlet.send(
                planning_scene(in_root, T_root_map_,
                               octomap_binary(scene_octree_of(view), view.resolution_m(), in_root)),
                wall);
        }
        case Form::binary:
            return topic.outlet.send(octomap_binary(octree_of(view), view.resolution_m(), in_map), wall);
        case Form::full:
            return topic.outlet.send(octomap_full(view, in_map), wall);
        case Form::cloud:
            return topic.outlet.send(occupied_cloud(view, in_map), wall);
        case Form::markers:
            return topic.outlet.send(occupied_markers(view, in_map), wall);
        case Form::grid:
            return topic.outlet.send(projected_map(view, in_map), wall);
    }
}

bool MapOutlets::is_due(const Topic& topic, HostTime now) const {
    if (!map_ || !map_->is_whole() || root_link_.empty()) return false;
    const bool is_urgent = obstacle_in_ > topic.sent.generation;
    return topic.pace.is_due(topic.sent, generation_, is_urgent, now) && topic.outlet.readers() > 0;
}

bool MapOutlets::is_due(HostTime now) const {
    return std::ranges::any_of(topics_, [&](const Topic& topic) { return is_due(topic, now); });
}

void MapOutlets::attend(HostTime now, WallTime wall) {
    std::optional<FusedMap> shown;
    for (Topic& topic : topics_) {
        if (!is_due(topic, now)) continue;
        if (!shown) shown = view();
        send(topic, *shown, wall);
        topic.sent = {now, generation_};
    }
}

void MapOutlets::forget_unread() {
    for (Topic& topic : topics_) {
        const bool is_old = topic.sent.when && topic.sent.generation != generation_;
        if (!is_old || topic.outlet.readers() > 0) continue;
        topic.outlet.forget_messages();
        topic.sent = {};
    }
}

std::vector<const Outlet*> MapOutlets::outlets() const {
    std::vector<const Outlet*> all;
    for (const Topic& topic : topics_) all.push_back(&topic.outlet);
    return all;
}

}  // namespace octoskin::bridge
