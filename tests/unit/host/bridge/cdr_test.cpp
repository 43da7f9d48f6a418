// Messages to bytes and back. The bytes of a small message are written down from the specification of CDR;
// tests/ros reads and writes the others with an implementation of another maker.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "host/bridge/cdr/cdr_reader.hpp"
#include "host/bridge/cdr/cdr_writer.hpp"
#include "ros_messages.hpp"

namespace octoskin {
namespace {

using cdr::Bytes;
using ros::moveit_msgs::PlanningScene;
using ros::sensor_msgs::JointState;

JointState two_joints() {
    return {
        .header = {{7, 9}, "ab"}, .name = {"x", "yz"}, .position = {1.0, -2.0}, .velocity = {}, .effort = {}};
}

/// Every list has an element, also in lists of lists.
PlanningScene full_scene() {
    PlanningScene scene;
    scene.name = "scene";
    scene.robot_state.joint_state = two_joints();
    ros::moveit_msgs::AttachedCollisionObject held;
    held.link_name = "hand";
    held.object.id = "cup";
    held.object.primitives = {{.type = 3, .dimensions = {0.1, 0.02}, .polygon = {{{1.0F, 2.0F, 3.0F}}}}};
    held.object.primitive_poses = {{{0.1, 0.2, 0.3}, {0, 0, 0, 1}}};
    held.object.meshes = {{{{{0, 1, 2}}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    held.object.mesh_poses = {{}};
    held.touch_links = {"finger"};
    held.detach_posture.points = {{.positions = {0.5}, .time_from_start = {1, 2}}};
    scene.robot_state.attached_collision_objects = {held};
    scene.allowed_collision_matrix.entry_names = {"a"};
    scene.allowed_collision_matrix.entry_values = {{{1}}};
    scene.link_padding = {{"a", 0.5}};
    scene.object_colors = {{"cup", {1.0F, 0.5F, 0.25F, 1.0F}}};
    scene.world.collision_objects = {held.object};
    scene.world.octomap.octomap = {{{1, 2}, "map"}, true, "OcTree", 0.04, {1, -2, 3}};
    scene.is_diff = true;
    return scene;
}

TEST(Cdr, has_the_bytes_of_the_specification) {
    const Bytes expected = {0, 1, 0, 0,                        // little-endian CDR
                            7, 0, 0, 0, 9,   0,   0,    0,     // stamp
                            3, 0, 0, 0, 'a', 'b', 0,    0,     // frame_id, then to a multiple of four
                            2, 0, 0, 0,                        // names
                            2, 0, 0, 0, 'x', 0,   0,    0,     //
                            3, 0, 0, 0, 'y', 'z', 0,    0,     //
                            2, 0, 0, 0,                        // positions, at a multiple of eight
                            0, 0, 0, 0, 0,   0,   0xF0, 0x3F,  //
                            0, 0, 0, 0, 0,   0,   0,    0xC0,  //
                            0, 0, 0, 0, 0,   0,   0,    0};    // no velocities, no efforts
    EXPECT_EQ(cdr::write(two_joints()), expected);
}

TEST(Cdr, gives_back_every_field) {
    const PlanningScene scene = full_scene();
    const Bytes bytes = cdr::write(scene);
    const auto back = cdr::read<PlanningScene>(bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(cdr::write(*back), bytes);
    EXPECT_EQ(back->robot_state.attached_collision_objects[0].object.primitives[0].polygon.points[0].z, 3.0F);
    EXPECT_EQ(back->world.octomap.octomap.data, (std::vector<std::int8_t>{1, -2, 3}));
    EXPECT_TRUE(back->is_diff);
}

TEST(Cdr, refuses_a_message_cut_at_any_byte) {
    const Bytes bytes = cdr::write(full_scene());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        const auto read = cdr::read<PlanningScene>(std::span(bytes).first(size));
        ASSERT_FALSE(read) << size;
        EXPECT_EQ(read.error(), cdr::Fault::too_short) << size;
    }
}

TEST(Cdr, refuses_another_encoding) {
    Bytes bytes = cdr::write(two_joints());
    for (const std::array<std::uint8_t, 2> kind :
         {std::array<std::uint8_t, 2>{0, 0}, {0, 3}, {0, 7}, {1, 1}}) {
        bytes[0] = kind[0];
        bytes[1] = kind[1];
        EXPECT_EQ(cdr::read<JointState>(bytes).error(), cdr::Fault::encoding) << int{kind[1]};
    }
}

TEST(Cdr, refuses_lengths_that_lie_before_it_takes_memory_for_them) {
    Bytes bytes = cdr::write(two_joints());
    const std::size_t names = 20;
    for (const std::uint8_t top : std::array<std::uint8_t, 3>{0x01, 0x7F, 0xFF}) {
        bytes[names + 3] = top;  // over 16 million names in 60 bytes
        EXPECT_EQ(cdr::read<JointState>(bytes).error(), cdr::Fault::too_short);
    }
}

TEST(Cdr, refuses_a_string_without_an_end_and_takes_one_of_no_bytes) {
    Bytes bytes = cdr::write(ros::std_msgs::String{"abc"});
    bytes.back() = 'd';
    EXPECT_EQ(cdr::read<ros::std_msgs::String>(bytes).error(), cdr::Fault::bad_string);
    const Bytes empty = {0, 1, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(cdr::read<ros::std_msgs::String>(empty).value().data, "");
}

TEST(Cdr, ignores_fields_that_a_newer_type_has_in_addition) {
    Bytes bytes = cdr::write(two_joints());
    bytes.insert(bytes.end(), {1, 2, 3});
    EXPECT_TRUE(cdr::read<JointState>(bytes));
}

TEST(Cdr, is_safe_for_damaged_bytes) {
    const Bytes sound = cdr::write(full_scene());
    std::mt19937 random(1);
    std::size_t refused = 0;
    for (int i = 0; i < 20'000; ++i) {
        Bytes bytes = sound;
        for (int k = 0; k < 4; ++k)
            bytes[4 + random() % (bytes.size() - 4)] = static_cast<std::uint8_t>(random());
        refused += cdr::read<PlanningScene>(bytes) ? 0U : 1U;
    }
    EXPECT_GT(refused, 1'000U);
    EXPECT_LT(refused, 20'000U);
}

}  // namespace
}  // namespace octoskin
