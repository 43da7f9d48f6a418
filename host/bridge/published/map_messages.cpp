#include "host/bridge/published/map_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "host/bridge/published/float_cloud.hpp"
#include "host/bridge/published/ros_values.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/io/mapfile/octomap_writer.hpp"

namespace octoskin::bridge {
namespace {

constexpr const char* kTreeId = "OcTree";

/// `data` of a message is what follows the line "data" of a file.
std::vector<std::int8_t> without_file_header(const std::string& file) {
    constexpr std::string_view kLast = "\ndata\n";
    const std::size_t at = file.find(kLast);
    if (at == std::string::npos) return {};
    const std::size_t begin = at + kLast.size();
    std::vector<std::int8_t> data(file.size() - begin);
    if (!data.empty()) std::memcpy(data.data(), file.data() + begin, data.size());
    return data;
}

double probability(float log_odds) {
    return 1.0 / (1.0 + std::exp(-static_cast<double>(log_odds)));
}

Eigen::Vector3d centre_of(const FusedMap& map, VoxelKey lowest, int voxels) {
    return map.centre_of(lowest) + Eigen::Vector3d::Constant(0.5 * (voxels - 1) * map.resolution_m());
}

bool is_occupied(const FusedMap& map, float log_odds) {
    return map.occupancy_of(log_odds) == Occupancy::occupied;
}

/// Those of a brick: eight occupied voxels with one parent are one cube.
void add_cubes(const FusedMap& map, const MapBrick& brick, std::vector<OccupiedCube>& cubes) {
    const double edge = map.resolution_m();
    const auto at = [&](std::size_t cell) { return brick.log_odds.at(cell); };
    const auto add = [&](std::size_t cell, int voxels) {
        cubes.push_back({centre_of(map, key_of_morton(brick.first + cell), voxels), edge * voxels, at(cell)});
    };
    if (brick.log_odds.values == nullptr) {
        if (is_occupied(map, brick.log_odds.value)) add(0, kBrickEdge);
        return;
    }
    for (std::size_t first = 0; first < kBrickVoxels; first += 8) {
        bool are_alike = true;
        for (std::size_t cell = first; cell < first + 8; ++cell) are_alike &= at(cell) == at(first);
        for (std::size_t cell = first; cell < first + (are_alike ? 1U : 8U); ++cell)
            if (is_occupied(map, at(cell))) add(cell, are_alike ? 2 : 1);
    }
}

/// As the colours of octomap_server: by height, blue below, red above.
ros::std_msgs::ColorRGBA colour_at(double share) {
    const double hue = 4.0 * std::clamp(1.0 - share, 0.0, 1.0);  // red 0, yellow 1, green 2, cyan 3, blue 4
    const auto ramp = [hue](double centre) {
        return static_cast<float>(std::clamp(2.0 - std::abs(hue - centre), 0.0, 1.0));
    };
    return {.r = ramp(0.0), .g = ramp(2.0), .b = ramp(4.0), .a = 1.0F};
}

}  // namespace

ros::octomap_msgs::Octomap octomap_binary(const BinaryOctree& octree, double resolution_m,
                                          const ros::std_msgs::Header& header) {
    return {header, true, kTreeId, resolution_m, octree.data()};
}

ros::octomap_msgs::Octomap octomap_full(const FusedMap& map, const ros::std_msgs::Header& header) {
    return {header, false, kTreeId, map.resolution_m(), without_file_header(encode_ot(map))};
}

ros::moveit_msgs::PlanningScene planning_scene(const ros::std_msgs::Header& header,
                                               const Eigen::Isometry3d& T_root_map,
                                               ros::octomap_msgs::Octomap octomap) {
    ros::moveit_msgs::PlanningScene scene;
    scene.is_diff = true;
    scene.robot_state.is_diff = true;  // else the scene would say that the robot holds nothing
    scene.world.octomap.header = header;
    scene.world.octomap.origin = ros_pose(T_root_map);
    scene.world.octomap.octomap = std::move(octomap);
    return scene;
}

std::vector<OccupiedCube> occupied_cubes(const FusedMap& map) {
    std::vector<OccupiedCube> cubes;
    for (const MapBrick& brick : map.bricks()) add_cubes(map, brick, cubes);
    return cubes;
}

ros::sensor_msgs::PointCloud2 occupied_cloud(const FusedMap& map, const ros::std_msgs::Header& header) {
    FloatCloud<7> cloud(header, {"x", "y", "z", "size", "occupancy", "age_s", "kind"});
    map.for_each_known([&](VoxelKey key, float log_odds) {
        if (!is_occupied(map, log_odds)) return;
        const Eigen::Vector3d centre = map.centre_of(key);
        const auto seen = map.confirmation(key);
        cloud.add({static_cast<float>(centre.x()), static_cast<float>(centre.y()),
                   static_cast<float>(centre.z()), static_cast<float>(map.resolution_m()),
                   static_cast<float>(probability(log_odds)),
                   seen ? static_cast<float>(seen->age_s) : std::numeric_limits<float>::quiet_NaN(),
                   static_cast<float>(seen ? seen->kind : SensorKind::none)});
    });
    return std::move(cloud).take();
}

ros::visualization_msgs::MarkerArray occupied_markers(const FusedMap& map,
                                                      const ros::std_msgs::Header& header) {
    const std::vector<OccupiedCube> cubes = occupied_cubes(map);
    double lowest = 0.0;
    double highest = 0.0;
    for (const OccupiedCube& cube : cubes) {
        lowest = &cube == cubes.data() ? cube.centre_map.z() : std::min(lowest, cube.centre_map.z());
        highest = &cube == cubes.data() ? cube.centre_map.z() : std::max(highest, cube.centre_map.z());
    }
    ros::visualization_msgs::MarkerArray array;
    std::array<int, 3> sizes = {1, 2, kBrickEdge};
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        ros::visualization_msgs::Marker marker;
        const double edge = sizes[i] * map.resolution_m();
        marker.header = header;
        marker.ns = "occupied";
        marker.id = static_cast<std::int32_t>(i);
        marker.type = ros::visualization_msgs::Marker::kCubeList;
        marker.pose.orientation.w = 1.0;
        marker.scale = {edge, edge, edge};
        marker.color = {.r = 0.5F, .g = 0.5F, .b = 0.5F, .a = 1.0F};
        for (const OccupiedCube& cube : cubes) {
            if (std::abs(cube.edge_m - edge) > 0.25 * map.resolution_m()) continue;
            marker.points.push_back(ros_point(cube.centre_map));
            marker.colors.push_back(
                colour_at(highest > lowest ? (cube.centre_map.z() - lowest) / (highest - lowest) : 0.0));
        }
        // A size without cubes removes those of the message before.
        marker.action = marker.points.empty() ? ros::visualization_msgs::Marker::kDelete
                                              : ros::visualization_msgs::Marker::kAdd;
        array.markers.push_back(std::move(marker));
    }
    return array;
}

ros::nav_msgs::OccupancyGrid projected_map(const FusedMap& map, const ros::std_msgs::Header& header) {
    ros::nav_msgs::OccupancyGrid grid;
    grid.header = header;
    grid.info.map_load_time = header.stamp;
    grid.info.resolution = static_cast<float>(map.resolution_m());
    grid.info.origin.orientation.w = 1.0;
    std::optional<KeyBox> box;
    map.for_each_known([&box](VoxelKey key, float) {
        if (!box) box = KeyBox{key, key};
        box->include(key);
    });
    if (!box) return grid;
    const int width = box->highest.x - box->lowest.x + 1;
    const int height = box->highest.y - box->lowest.y + 1;
    if (width > kGridSideMax || height > kGridSideMax) return grid;
    grid.info.width = static_cast<std::uint32_t>(width);
    grid.info.height = static_cast<std::uint32_t>(height);
    const Eigen::Vector3d corner =
        map.centre_of(box->lowest) - Eigen::Vector3d::Constant(0.5 * map.resolution_m());
    grid.info.origin.position = {corner.x(), corner.y(), 0.0};
    grid.data.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
    map.for_each_known([&](VoxelKey key, float log_odds) {
        std::int8_t& cell = grid.data[static_cast<std::size_t>(key.y - box->lowest.y) * grid.info.width +
                                      (key.x - box->lowest.x)];
        cell = std::max<std::int8_t>(cell, is_occupied(map, log_odds) ? 100 : 0);
    });
    return grid;
}

}  // namespace octoskin::bridge
