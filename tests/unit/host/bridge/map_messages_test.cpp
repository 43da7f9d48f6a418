// The map as messages, read by OctoMap's own code, and what is left out of it.
#include "host/bridge/published/map_messages.hpp"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cstring>
#include <memory>
#include <random>
#include <set>
#include <sstream>

#include "host/bridge/published/map_view.hpp"
#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {
namespace {

constexpr double kEdge = 0.04;

VoxelKey key(int x, int y, int z) {
    const auto at = [](int value) { return static_cast<std::uint16_t>(kOriginKey + value); };
    return {at(x), at(y), at(z)};
}

void set(FusedMap& map, VoxelKey key, float log_odds) {
    ASSERT_TRUE(map.set_cube({key, 0}, log_odds));
}

/// Random voxels about the origin, occupied, free and unknown, and a whole brick of each.
FusedMap random_map(unsigned seed) {
    FusedMap map({.resolution_m = kEdge});
    std::mt19937 random(seed);
    for (int i = 0; i < 3000; ++i) {
        const auto coordinate = [&random] { return static_cast<int>(random() % 60) - 30; };
        set(map, key(coordinate(), coordinate(), coordinate()), random() % 2 == 0 ? 1.5F : -0.5F);
    }
    EXPECT_TRUE(map.set_cube({key(64, 64, 64), 3}, 2.0F));
    EXPECT_TRUE(map.set_cube({key(-64, 64, 64), 3}, -2.0F));
    return map;
}

/// As octomap_msgs reads a message.
std::unique_ptr<octomap::OcTree> read(const ros::octomap_msgs::Octomap& message) {
    EXPECT_EQ(message.id, "OcTree");
    auto tree = std::make_unique<octomap::OcTree>(message.resolution);
    std::stringstream data(
        std::string(reinterpret_cast<const char*>(message.data.data()), message.data.size()));
    message.binary ? tree->readBinaryData(data) : tree->readData(data);
    EXPECT_EQ(data.peek(), std::char_traits<char>::eof()) << "nothing is left";
    return tree;
}

Occupancy in_tree(const octomap::OcTree& tree, VoxelKey at) {
    const octomap::OcTreeNode* const node = tree.search(octomap::OcTreeKey(at.x, at.y, at.z));
    if (node == nullptr) return Occupancy::unknown;
    return tree.isNodeOccupied(node) ? Occupancy::occupied : Occupancy::free;
}

void expect_equal(const octomap::OcTree& tree, const FusedMap& map) {
    int different = 0;
    for (int x = -70; x < 75; ++x)
        for (int y = -40; y < 75; ++y)
            for (int z = -40; z < 75; ++z)
                different += in_tree(tree, key(x, y, z)) == map.occupancy(key(x, y, z)) ? 0 : 1;
    EXPECT_EQ(different, 0);
}

const ros::std_msgs::Header kHeader = ros_header(WallTime{5'000'000'001}, "octoskin_map");

ros::octomap_msgs::Octomap binary_of(const FusedMap& map) {
    BinaryOctree octree;
    octree.update(map.layers().log_odds, map.config().log_odds_occupied);
    return octomap_binary(octree, map.resolution_m(), kHeader);
}

TEST(MapMessages, are_octomaps_that_octomap_reads) {
    const FusedMap map = random_map(1);
    const auto binary = binary_of(map);
    EXPECT_TRUE(binary.binary);
    EXPECT_EQ(binary.resolution, kEdge);
    EXPECT_EQ(binary.header.frame_id, "octoskin_map");
    EXPECT_EQ(binary.header.stamp.nanosec, 1U);
    expect_equal(*read(binary), map);
    const auto full = octomap_full(map, kHeader);
    EXPECT_FALSE(full.binary);
    const auto tree = read(full);
    expect_equal(*tree, map);
    EXPECT_EQ(tree->search(octomap::OcTreeKey(key(64, 64, 64).x, key(64, 64, 64).y, key(64, 64, 64).z))
                  ->getLogOdds(),
              2.0F);
}

TEST(MapMessages, of_an_empty_map_have_no_data) {
    const FusedMap map({.resolution_m = kEdge});
    EXPECT_TRUE(binary_of(map).data.empty());
    EXPECT_TRUE(occupied_cloud(map, kHeader).data.empty());
    EXPECT_EQ(projected_map(map, kHeader).info.width, 0U);
}

TEST(MapMessages, judge_by_the_maps_threshold) {
    FusedMap map({.resolution_m = kEdge, .log_odds_occupied = 1.0F});
    set(map, key(0, 0, 0), 0.9F);
    set(map, key(1, 0, 0), 1.1F);
    const auto tree = read(binary_of(map));
    EXPECT_EQ(in_tree(*tree, key(0, 0, 0)), Occupancy::free);
    EXPECT_EQ(in_tree(*tree, key(1, 0, 0)), Occupancy::occupied);
}

TEST(MapMessages, make_a_scene_that_changes_the_octomap_only) {
    Eigen::Isometry3d T_root_map = Eigen::Isometry3d::Identity();
    T_root_map.translate(Eigen::Vector3d(0.1, 0.2, 0.3));
    T_root_map.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
    const auto scene = planning_scene(ros_header({}, "world"), T_root_map, binary_of(random_map(1)));
    EXPECT_TRUE(scene.is_diff);
    EXPECT_TRUE(scene.robot_state.is_diff);
    EXPECT_EQ(scene.world.octomap.header.frame_id, "world");
    EXPECT_EQ(scene.world.octomap.origin.position.z, 0.3);
    EXPECT_NEAR(scene.world.octomap.origin.orientation.x, std::sin(0.25), 1e-12);
    EXPECT_TRUE(scene.robot_model_name.empty());
    EXPECT_TRUE(scene.fixed_frame_transforms.empty());
    EXPECT_TRUE(scene.world.collision_objects.empty());
}

TEST(MapMessages, have_each_occupied_voxel_once) {
    const FusedMap map = random_map(2);
    std::set<VoxelKey> occupied;
    map.for_each_known([&](VoxelKey at, float log_odds) {
        if (map.occupancy_of(log_odds) == Occupancy::occupied) occupied.insert(at);
    });
    const auto cloud = occupied_cloud(map, kHeader);
    ASSERT_EQ(cloud.point_step, 28U);
    ASSERT_EQ(cloud.fields.size(), 7U);
    std::set<VoxelKey> in_cloud;
    for (std::size_t i = 0; i < cloud.width; ++i) {
        std::array<float, 7> point{};
        std::memcpy(point.data(), cloud.data.data() + i * cloud.point_step, sizeof(point));
        const Eigen::Vector3f centre(point[0], point[1], point[2]);
        in_cloud.insert(map.key_of(centre.cast<double>()).value());
        EXPECT_EQ(point[3], static_cast<float>(kEdge));
        EXPECT_GT(point[4], 0.5F);
    }
    EXPECT_EQ(in_cloud, occupied);
    double volume = 0.0;
    for (const OccupiedCube& cube : occupied_cubes(map)) {
        volume += std::pow(cube.edge_m / kEdge, 3);
        EXPECT_EQ(map.occupancy(map.key_of(cube.centre_map).value()), Occupancy::occupied);
    }
    EXPECT_NEAR(volume, static_cast<double>(occupied.size()), 1e-6);
    std::size_t points = 0;
    for (const auto& marker : occupied_markers(map, kHeader).markers) {
        points += marker.points.size();
        EXPECT_EQ(marker.points.size(), marker.colors.size());
        EXPECT_EQ(marker.action, marker.points.empty() ? ros::visualization_msgs::Marker::kDelete
                                                       : ros::visualization_msgs::Marker::kAdd);
    }
    EXPECT_EQ(points, occupied_cubes(map).size());
}

TEST(MapMessages, project_columns) {
    FusedMap map({.resolution_m = kEdge});
    set(map, key(0, 0, 0), -1.0F);
    set(map, key(0, 0, 5), 1.0F);
    set(map, key(2, 1, 0), -1.0F);
    const auto grid = projected_map(map, kHeader);
    EXPECT_EQ(grid.info.width, 3U);
    EXPECT_EQ(grid.info.height, 2U);
    EXPECT_NEAR(grid.info.origin.position.x, 0.0, 1e-12);
    EXPECT_EQ(grid.data, (std::vector<std::int8_t>{100, -1, -1, -1, -1, 0}));
}

TEST(MapView, leaves_out_the_occupied_voxels_of_an_object) {
    const FusedMap map = random_map(3);
    Solid ball{Ball{0.5}};
    ball.T_map_solid.translate(Eigen::Vector3d(0.2, 0.1, 0.0));
    const CutMap cut = without(map, std::vector<Solid>{ball}, 0.05);
    int left_out = 0;
    map.for_each_known([&](VoxelKey at, float log_odds) {
        const double distance = (map.centre_of(at) - ball.T_map_solid.translation()).norm() - 0.5;
        const bool is_occupied = map.occupancy_of(log_odds) == Occupancy::occupied;
        const bool is_out = is_occupied && distance <= 0.05 + 0.5 * std::sqrt(3.0) * kEdge;
        EXPECT_EQ(cut.map.occupancy(at), is_out ? Occupancy::unknown : map.occupancy(at));
        left_out += is_out ? 1 : 0;
    });
    EXPECT_GT(left_out, 20);
    EXPECT_EQ(cut.solids_left_in, 0U);
    expect_equal(*read(binary_of(cut.map)), cut.map);
}

TEST(MapView, leaves_in_what_takes_too_much_work) {
    const FusedMap map = random_map(3);
    EXPECT_EQ(without(map, std::vector<Solid>{{Ball{900.0}}}, 0.0).solids_left_in, 0U);
    const std::vector<Solid> many(3, Solid{Ball{900.0}});
    const CutMap cut = without(map, many, 0.0, 10);
    EXPECT_EQ(cut.solids_left_in, 3U);
    expect_equal(*read(binary_of(cut.map)), map);
    // As many spheres as a scene can have: bounded work.
    EXPECT_GT(without(map, std::vector<Solid>(4096, Solid{Ball{900.0}}), 0.0).solids_left_in, 3000U);
}

TEST(MapView, has_unknown_space_of_a_box_as_obstacles_but_for_the_robots_own) {
    const FusedMap map = random_map(4);
    const Eigen::AlignedBox3d box(Eigen::Vector3d(-0.5, -0.4, -0.3), Eigen::Vector3d(0.5, 0.4, 0.3));
    const std::vector<PosedCapsule> body = {{{0, 0, -0.2}, {0, 0, 0.2}, 0.1, 0}};
    const FusedMap filled = with_unknown_occupied(map, box, body, 0.05);
    int own = 0;
    int added = 0;
    for (int x = -16; x < 16; ++x)
        for (int y = -16; y < 16; ++y)
            for (int z = -16; z < 16; ++z) {
                const VoxelKey at = key(x, y, z);
                const Eigen::Vector3d centre = map.centre_of(at);
                const bool is_unknown = map.occupancy(at) == Occupancy::unknown && box.contains(centre);
                const bool is_own = is_unknown && distance_to_surface(body[0], centre) <= 0.05;
                own += is_own ? 1 : 0;
                added += is_unknown && !is_own ? 1 : 0;
                EXPECT_EQ(filled.occupancy(at),
                          is_unknown && !is_own ? Occupancy::occupied : map.occupancy(at));
            }
    EXPECT_GT(own, 50);
    EXPECT_GT(added, 1000);
    expect_equal(*read(binary_of(filled)), filled);
}

}  // namespace
}  // namespace octoskin::bridge
