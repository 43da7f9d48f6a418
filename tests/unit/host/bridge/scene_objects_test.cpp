// The planner's objects by MoveIt's rules, and their distances.
#include "host/bridge/received/scene_objects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/cases.hpp"

namespace octoskin::bridge {
namespace {

using ros::moveit_msgs::CollisionObject;
using ros::moveit_msgs::PlanningScene;
using ros::shape_msgs::SolidPrimitive;

PlanningScene scene_diff() {
    PlanningScene scene;
    scene.is_diff = true;
    scene.robot_state.is_diff = true;
    return scene;
}

CollisionObject box(const std::string& id, const std::string& frame, double x) {
    CollisionObject object;
    object.id = id;
    object.header.frame_id = frame;
    object.pose.position.x = x;
    object.primitives = {{.type = SolidPrimitive::kBox, .dimensions = {0.2, 0.2, 0.2}, .polygon = {}}};
    object.primitive_poses = {{{0, 0, 0}, {0, 0, 0, 1}}};
    return object;
}

std::optional<Eigen::Isometry3d> frame(const std::string& name) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    if (name == "hand") T.translation().z() = 1.0;
    return name == "hand" || name == "world" ? std::optional(T) : std::nullopt;
}

class SceneObjectsTest : public testing::Test {
  protected:
    void take(const CollisionObject& object, std::uint8_t operation) {
        PlanningScene scene = scene_diff();
        scene.world.collision_objects = {object};
        scene.world.collision_objects[0].operation = operation;
        objects_.take(scene);
    }
    void hold(const CollisionObject& object, std::uint8_t operation) {
        PlanningScene scene = scene_diff();
        ros::moveit_msgs::AttachedCollisionObject held;
        held.link_name = "hand";
        held.object = object;
        held.object.operation = operation;
        scene.robot_state.attached_collision_objects = {held};
        objects_.take(scene);
    }
    std::vector<Solid> solids() const { return objects_.placed(frame).solids; }
    SceneObjects objects_;
};

TEST_F(SceneObjectsTest, are_added_moved_and_removed) {
    take(box("a", "world", 1.0), CollisionObject::kAdd);
    take(box("b", "world", 2.0), CollisionObject::kAdd);
    ASSERT_EQ(solids().size(), 2U);
    take(box("a", "world", 3.0), CollisionObject::kMove);
    EXPECT_EQ(solids()[0].T_map_solid.translation().x(), 3.0);
    take(box("a", "world", 3.0), CollisionObject::kAppend);
    EXPECT_EQ(solids().size(), 3U);
    take(box("a", "world", 0.0), CollisionObject::kRemove);
    EXPECT_EQ(solids().size(), 1U);
    take(box("", "world", 0.0), CollisionObject::kRemove);
    EXPECT_TRUE(solids().empty()) << "without an id: all";
}

TEST_F(SceneObjectsTest, that_the_robot_takes_are_no_longer_in_the_world) {
    take(box("cup", "world", 1.0), CollisionObject::kAdd);
    hold(box("cup", "hand", 0.25), CollisionObject::kAdd);
    EXPECT_EQ(objects_.in_world(), 0U);
    EXPECT_EQ(objects_.held(), 1U);
    ASSERT_EQ(solids().size(), 1U);
    EXPECT_EQ(solids()[0].T_map_solid.translation(), Eigen::Vector3d(0.25, 0.0, 1.0))
        << "it moves with the hand";
    hold(box("cup", "hand", 0.0), CollisionObject::kRemove);
    EXPECT_TRUE(solids().empty());
}

TEST_F(SceneObjectsTest, of_a_whole_scene_replace_all_others) {
    take(box("a", "world", 1.0), CollisionObject::kAdd);
    hold(box("cup", "hand", 0.25), CollisionObject::kAdd);
    PlanningScene whole;
    whole.world.collision_objects = {box("b", "world", 2.0)};
    objects_.take(whole);
    ASSERT_EQ(solids().size(), 1U);
    EXPECT_EQ(solids()[0].T_map_solid.translation().x(), 2.0);
}

TEST_F(SceneObjectsTest, in_a_frame_that_is_not_known_are_named) {
    take(box("a", "table", 1.0), CollisionObject::kAdd);
    EXPECT_EQ(objects_.placed(frame).unplaced, std::vector<std::string>{"table"});
    EXPECT_TRUE(solids().empty());
}

TEST_F(SceneObjectsTest, that_are_wrong_are_counted) {
    CollisionObject object = box("a", "world", std::nan(""));
    take(object, CollisionObject::kAdd);
    object = box("b", "world", 0.0);
    object.primitives[0].dimensions = {0.2, -0.2, 0.2};
    take(object, CollisionObject::kAdd);
    object.primitives[0].dimensions = {0.2};
    take(object, CollisionObject::kAdd);
    EXPECT_EQ(objects_.counts().invalid, 3U);
    object.primitives[0].type = SolidPrimitive::kPrism;
    object.planes = {{}};
    take(object, CollisionObject::kAdd);
    EXPECT_EQ(objects_.counts().unsupported, 2U);
    object = box("c", "world", 0.0);
    object.meshes = {{{{{0, 1, 3}}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    object.mesh_poses = {{}};
    take(object, CollisionObject::kAdd);
    EXPECT_EQ(objects_.counts().invalid, 4U) << "an index beyond the vertices";
    for (int i = 0; i < 1100; ++i) take(box(std::to_string(i), "world", 0.0), CollisionObject::kAdd);
    EXPECT_EQ(objects_.in_world(), SceneObjects::kObjectsMax);
    EXPECT_GT(objects_.counts().too_many, 70U);
    const std::uint64_t before = objects_.counts().too_many;
    CollisionObject many = box("0", "world", 0.0);
    many.primitives.assign(3000, many.primitives[0]);
    for (int i = 0; i < 3; ++i) take(many, CollisionObject::kAppend);
    EXPECT_EQ(objects_.counts().too_many, before + 2) << "shapes are limited, too";
}

/// A closed mesh of a box of these edges, every triangle outwards.
MeshSolid mesh_of_box(const Eigen::Vector3d& half) {
    MeshSolid mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.emplace_back((i & 1 ? 1 : -1) * half.x(), (i & 2 ? 1 : -1) * half.y(),
                                   (i & 4 ? 1 : -1) * half.z());
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

/// Points of a shape's surface and inside, by its definition; the distance is that to the nearest of them.
class Sampled {
  public:
    template <class Inside>
    Sampled(double extent, Inside inside) {
        constexpr int kSteps = 25;
        for (int x = -kSteps; x <= kSteps; ++x)
            for (int y = -kSteps; y <= kSteps; ++y)
                for (int z = -kSteps; z <= kSteps; ++z)
                    if (const Eigen::Vector3d p = extent / kSteps * Eigen::Vector3d(x, y, z); inside(p))
                        points_.push_back(p);
        step_ = extent / kSteps;
    }
    double distance(const Eigen::Vector3d& p) const {
        double nearest = 1e9;
        for (const Eigen::Vector3d& point : points_) nearest = std::min(nearest, (point - p).squaredNorm());
        return std::sqrt(nearest);
    }
    double error() const { return std::sqrt(3.0) * step_; }

  private:
    std::vector<Eigen::Vector3d> points_;
    double step_ = 0.0;
};

void expect_distances(const Solid& shape, const Sampled& sampled, double extent) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-2.0 * extent, 2.0 * extent);
    std::uniform_real_distribution<double> reach(0.0, extent);
    int near = 0;
    for (unsigned i = 0; i < testing_support::cases(300); ++i) {
        const Eigen::Vector3d p(coordinate(random), coordinate(random), coordinate(random));
        const double distance = sampled.distance(p);
        const double within = reach(random);
        if (std::abs(distance - within) < sampled.error()) continue;
        near += distance < within ? 1 : 0;
        EXPECT_EQ(is_within(shape, p, within), distance < within) << p.transpose() << " within " << within;
    }
    EXPECT_GT(near, 3);
}

TEST(Solids, are_as_far_as_their_points) {
    const Eigen::Vector3d half(0.3, 0.1, 0.2);
    const Sampled box_points(
        0.3, [&](const Eigen::Vector3d& p) { return (p.cwiseAbs() - half).maxCoeff() <= 1e-9; });
    expect_distances({Box{half}}, box_points, 0.3);
    expect_distances({std::make_shared<const MeshSolid>(mesh_of_box(half))}, box_points, 0.3);
    expect_distances({Ball{0.2}}, Sampled(0.2, [](const Eigen::Vector3d& p) { return p.norm() <= 0.2; }),
                     0.2);
    const auto rho = [](const Eigen::Vector3d& p) { return std::hypot(p.x(), p.y()); };
    expect_distances(
        {Cylinder{0.1, 0.3}},
        Sampled(0.3, [&](const Eigen::Vector3d& p) { return rho(p) <= 0.1 && std::abs(p.z()) <= 0.3; }), 0.3);
    expect_distances({Cone{0.2, 0.3}},
                     Sampled(0.3,
                             [&](const Eigen::Vector3d& p) {
                                 return std::abs(p.z()) <= 0.3 && rho(p) <= 0.2 * (0.3 - p.z()) / 0.6;
                             }),
                     0.3);
}

TEST(Solids, turn_with_their_pose) {
    Solid box{Box{{0.5, 0.1, 0.1}}};
    EXPECT_TRUE(is_within(box, {0.45, 0, 0}, 0.0));
    box.T_map_solid.rotate(Eigen::AngleAxisd(std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ()));
    box.T_map_solid.pretranslate(Eigen::Vector3d(0, 0, 1));
    EXPECT_FALSE(is_within(box, {0.45, 0, 1}, 0.0));
    EXPECT_TRUE(is_within(box, {0, 0.45, 1}, 0.0));
}

}  // namespace
}  // namespace octoskin::bridge
