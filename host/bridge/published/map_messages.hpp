// The map as messages of ROS 2. Frame and time of each are the caller's.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host/bridge/published/binary_octree.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

/// OctoMap's .bt without its file header: occupied, free and unknown as the map's threshold says.
[[nodiscard]] ros::octomap_msgs::Octomap octomap_binary(const BinaryOctree& octree, double resolution_m,
                                                        const ros::std_msgs::Header& header);
/// OctoMap's .ot without its file header: log-odds. A reader judges occupied by its own threshold. O(voxels).
[[nodiscard]] ros::octomap_msgs::Octomap octomap_full(const FusedMap& map,
                                                      const ros::std_msgs::Header& header);

/// A scene that changes the octomap of MoveIt and nothing else: both `is_diff` are true, all lists are empty.
/// `header`: of the URDF's root link; `octomap`: a binary one.
[[nodiscard]] ros::moveit_msgs::PlanningScene planning_scene(const ros::std_msgs::Header& header,
                                                             const Eigen::Isometry3d& T_root_map,
                                                             ros::octomap_msgs::Octomap octomap);

/// Centre, edge (metres) and log-odds of an occupied leaf: a voxel, or a cube of eight, 64, ... equal ones.
struct OccupiedCube {
    Eigen::Vector3d centre_map = Eigen::Vector3d::Zero();
    double edge_m = 0.0;
    float log_odds = 0.0F;
};
/// The occupied voxels, eight of one parent as one cube, in Morton order. O(voxels).
[[nodiscard]] std::vector<OccupiedCube> occupied_cubes(const FusedMap& map);

/// Each occupied voxel as a point: x, y, z, size (metres), occupancy (probability), age_s (NaN: not known)
/// and kind (0 none, 1 range, 2 camera), seven floats. Frame of the map. O(voxels).
[[nodiscard]] ros::sensor_msgs::PointCloud2 occupied_cloud(const FusedMap& map,
                                                           const ros::std_msgs::Header& header);
/// A CUBE_LIST for each edge length. Frame of the map. O(voxels).
[[nodiscard]] ros::visualization_msgs::MarkerArray occupied_markers(const FusedMap& map,
                                                                    const ros::std_msgs::Header& header);
/// Columns along the map's z: 100 with an occupied voxel, 0 with a free one only, -1 unknown. Empty if the
/// map is; at most kGridSideMax cells a side, else empty. O(voxels).
inline constexpr int kGridSideMax = 8192;
[[nodiscard]] ros::nav_msgs::OccupancyGrid projected_map(const FusedMap& map,
                                                         const ros::std_msgs::Header& header);

}  // namespace octoskin::bridge
