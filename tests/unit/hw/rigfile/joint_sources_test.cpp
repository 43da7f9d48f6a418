// Several sources of joint states in a rig.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "hw/rigfile/can_load.hpp"
#include "hw/rigfile/rig.hpp"
#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

const std::filesystem::path kRigFiles = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/rigs";

class JointSources : public testing::Test {
  protected:
    Result<Rig, Error> read(const std::string& joints,
                            const std::filesystem::path& urdf = kRigFiles / "eight-joints.urdf",
                            const std::string& base_link = "base") {
        const std::filesystem::path file = folder_ / "rig.yaml";
        std::ofstream(file) << "extends: " << (kRigFiles / "one-sensor.yaml").string()
                            << "\nrobot:\n  urdf: " << urdf.string() << "\n  base_link: " << base_link
                            << "\nsensor_defaults:\n  link: l7\njoints:" << joints << "\n";
        return read_rig(file);
    }
    Error refused(const std::string& joints) {
        const auto rig = read(joints);
        EXPECT_FALSE(rig);
        return rig ? Error{} : rig.error();
    }
    std::filesystem::path robot_of(int joints) {
        std::ofstream urdf(folder_ / "many.urdf");
        urdf << "<robot name=\"many\"><link name=\"base\"/>";
        for (int i = 0; i < joints; ++i)
            urdf << "<link name=\"l" << i << "\"/><joint name=\"j" << i
                 << "\" type=\"continuous\"><parent link=\""
                 << (i == 0 ? "base" : "l" + std::to_string(i - 1)) << "\"/><child link=\"l" << i
                 << "\"/><axis xyz=\"0 0 1\"/></joint>";
        urdf << "</robot>";
        return folder_ / "many.urdf";
    }
    /// Sources of seven of the joints j0, j1 ...
    static std::string sources_of(int joints) {
        std::string text;
        for (int first = 0; first < joints; first += 7) {
            text += "\n  - {node_id: " + std::to_string(10 + first) + ", rate_hz: 50, names: [";
            for (int i = first; i < std::min(first + 7, joints); ++i)
                text += (i > first ? ", j" : "j") + std::to_string(i);
            text += "]}";
        }
        return text;
    }

    testing_support::ScratchFolder folder_;
};

constexpr const char* kTwo =
    "\n  - {node_id: 9, rate_hz: 100, names: [j0, j1, j2, j3, j4, j5]}"
    "\n  - {node_id: 10, rate_hz: 20, names: [j7, j6], via: socket}";

TEST_F(JointSources, are_a_list_each_with_its_node_names_rate_and_way) {
    const auto rig = read(kTwo);
    ASSERT_TRUE(rig) << rig.error().message();
    ASSERT_EQ(rig->joint_sources.size(), 2U);
    EXPECT_EQ(rig->joint_sources[0].node_id, 9);
    EXPECT_EQ(rig->joint_sources[0].way, JointWay::can);
    EXPECT_EQ(rig->joint_sources[1].node_id, 10);
    EXPECT_EQ(rig->joint_sources[1].rate_hz, 20.0);
    EXPECT_EQ(rig->joint_sources[1].way, JointWay::socket);
    EXPECT_EQ(rig->joint_names(), (std::vector<std::string>{"j0", "j1", "j2", "j3", "j4", "j5", "j7", "j6"}));
    EXPECT_EQ(rig->joint_counts(), (std::vector<std::size_t>{6, 2}));
}

TEST_F(JointSources, are_the_same_after_the_canonical_text) {
    const Rig rig = read(kTwo).value();
    const std::string text = canonical_text(rig, (kRigFiles / "eight-joints.urdf").string());
    const std::filesystem::path file = folder_ / "again.yaml";
    std::ofstream(file) << text;
    const auto again = read_rig(file);
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_EQ(canonical_text(*again, (kRigFiles / "eight-joints.urdf").string()), text);
    EXPECT_EQ(rig_hash(*again), rig_hash(rig));
    EXPECT_EQ(again->joint_sources[1].way, JointWay::socket);
    EXPECT_EQ(placement_crc32(rig, ""),
              placement_crc32(read("\n  - {node_id: 9, rate_hz: 100, names: [j0, j1, j2, j3, "
                                   "j4, j5]}\n  - {node_id: 10, rate_hz: 20, names: [j6, "
                                   "j7]}")
                                  .value(),
                              ""))
        << "a joint is known by its name";
}

TEST_F(JointSources, of_the_bus_are_counted_in_its_load) {
    const auto load = [&](const char* second) {
        return can_load(read("\n  - {node_id: 9, rate_hz: 100, names: [j0, j1, j2, j3, j4, j5, j6]}" +
                             std::string(second))
                            .value());
    };
    const double by_socket = load("\n  - {node_id: 10, rate_hz: 100, names: [j7], via: socket}");
    const double by_can = load("\n  - {node_id: 10, rate_hz: 100, names: [j7]}");
    // Four frames of 8 bytes a sample at 500 kbit/s, and the node's own reports.
    EXPECT_GT(by_can - by_socket, 100 * 4 * 135 / 500e3);
    EXPECT_LT(by_can - by_socket, 1.1 * 100 * 4 * 135 / 500e3);
}

TEST_F(JointSources, have_up_to_32_joints_in_all) {
    const auto most = read(sources_of(32), robot_of(32));
    ASSERT_TRUE(most) << most.error().message();
    EXPECT_EQ(most->joint_names().size(), 32U);
    const auto more = read(sources_of(33), robot_of(33));
    ASSERT_FALSE(more);
    EXPECT_EQ(more.error().code, ErrorCode::limit_exceeded);
    EXPECT_THAT(more.error().value, HasSubstr("33 in many.urdf"));
}

TEST_F(JointSources, are_refused_with_the_key_and_the_value) {
    const std::string first = "\n  - {node_id: 9, rate_hz: 100, names: [j0, j1, j2, j3, j4, j5]}";
    const Error twice = refused(first + "\n  - {node_id: 10, rate_hz: 20, names: [j6, j7, j5]}");
    EXPECT_EQ(twice.code, ErrorCode::duplicate);
    EXPECT_EQ(twice.key, "joints[1].names");
    EXPECT_EQ(twice.value, "'j5' again");
    const Error same_id = refused(first + "\n  - {node_id: 9, rate_hz: 20, names: [j6, j7]}");
    EXPECT_EQ(same_id.code, ErrorCode::duplicate);
    EXPECT_EQ(same_id.key, "joints[1].node_id");
    const Error id_of_board = refused(first + "\n  - {node_id: 1, rate_hz: 20, names: [j6, j7]}");
    EXPECT_EQ(id_of_board.code, ErrorCode::duplicate);
    EXPECT_THAT(id_of_board.remedy, HasSubstr("'board'"));
    const Error missing = refused(first + "\n  - {node_id: 10, rate_hz: 20, names: [j7]}");
    EXPECT_EQ(missing.code, ErrorCode::missing_key);
    EXPECT_EQ(missing.value, "none named j6");
    EXPECT_EQ(missing.key, "joints");
    EXPECT_EQ(refused(" []").code, ErrorCode::limit_exceeded);
    EXPECT_EQ(refused(first + "\n  - {node_id: 10, rate_hz: 20, names: []}").code, ErrorCode::limit_exceeded);
    EXPECT_EQ(refused(first + "\n  - {node_id: 10, rate_hz: 20, names: [j6, j7], via: radio}").code,
              ErrorCode::unknown_word);
    EXPECT_EQ(refused(first + "\n  - 5").code, ErrorCode::wrong_type);
}

// A link that a joint moves has no fixed place in the map. A mobile base's joint is not the robot's.
TEST_F(JointSources, need_a_base_link_that_no_joint_moves) {
    const auto moved = read(" {node_id: 9, rate_hz: 100, names: [j1, j2, j3, j4, j5, j6, j7]}",
                            kRigFiles / "eight-joints.urdf", "l0");
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().code, ErrorCode::conflict);
    EXPECT_EQ(moved.error().key, "robot.base_link");
    EXPECT_THAT(moved.error().value, HasSubstr("joint 'j0' moves"));
    EXPECT_THAT(moved.error().remedy, HasSubstr("'base'"));

    std::ofstream(folder_ / "mobile.urdf")
        << "<robot name=\"mobile\"><link name=\"world\"/><link name=\"base\"/><link name=\"l7\"/>"
           "<joint name=\"drive\" type=\"planar\"><parent link=\"world\"/><child link=\"base\"/></joint>"
           "<joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"l7\"/>"
           "<axis xyz=\"0 0 1\"/></joint></robot>";
    const auto mobile = read(" {node_id: 9, rate_hz: 100, names: [j]}", folder_ / "mobile.urdf");
    EXPECT_TRUE(mobile) << mobile.error().message();
}

}  // namespace
}  // namespace octoskin::rig
