// One file in tests/data/rigs for each thing that can be wrong with a rig, named by its defect. Each is
// refused with the file, the line, the key, and a message that says what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <ostream>
#include <set>
#include <string>

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {
namespace {

using testing::HasSubstr;

const std::filesystem::path kData = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/rigs";

struct Broken {
    const char* file;
    int line;
    const char* key;
    const char* words;  ///< part of the message
    friend std::ostream& operator<<(std::ostream& out, const Broken& broken) { return out << broken.file; }
};

const Broken kBroken[] = {
    // What is no rig at all.
    {"not-yaml.yaml", 3, "", "not YAML"},
    {"empty.yaml", 1, "", "expected a table of keys at the top"},
    {"list-at-top.yaml", 1, "", "expected a table of keys at the top"},
    {"two-documents.yaml", 3, "", "expected one YAML document"},
    {"repeated-key.yaml", 4, "name", "first at line 2"},
    {"anchor.yaml", 2, "", "anchors"},
    {"tag.yaml", 2, "", "tags are not used here: remove '!text'"},
    {"nested-too-deep.yaml", 2, "", "nested deeper than 16"},
    {"list-as-key.yaml", 2, "", "expected a key, found a list"},
    {"extends-itself.yaml", 0, "extends", "is there a circle?"},
    {"extends-absent.yaml", 2, "extends", "no-such-rig.yaml"},
    // Keys.
    {"unknown-key.yaml", 2, "cammera", "did you mean camera?"},
    {"unknown-key-like-none.yaml", 2, "wavelength_nm", "known here are name, robot, T_map_base, bus"},
    {"millimetres-in-the-key.yaml", 3, "nodes[0].sensors[0].pose.xyz_mm",
     "did you mean nodes[0].sensors[0].pose.xyz_m? (the unit is part of the name"},
    {"key-without-its-unit.yaml", 3, "nodes[0].sensors[0].timing_budget",
     "did you mean nodes[0].sensors[0].timing_budget_ms?"},
    {"unknown-key-like-extends.yaml", 1, "extend", "did you mean extends?"},
    {"missing-key.yaml", 2, "bus.nominal_bitrate_bps", "expected this key, found none"},
    {"sensor-in-a-replaced-list-lacks-a-key.yaml", 7, "nodes[0].sensors[0].address",
     "add it (a list replaces the inherited one as a whole)"},
    {"no-nodes.yaml", 2, "nodes", "expected 1 to 61 nodes, found 0"},
    {"two-rows-of-a-rotation.yaml", 4, "T_map_base.rotation_rows",
     "expected a list of 3 rows, found a list of 2"},
    {"list-for-the-padding.yaml", 3, "robot.link_padding_m", "expected a table of link names and metres"},
    {"more-joints-than-a-sample-holds.yaml", 7, "joints.names",
     "expected 1 to 7 joints, found 8 in eight-joints.urdf: make those that stay as they are type=\"fixed\" "
     "there"},
    {"seven-of-eight-joints.yaml", 7, "joints.names",
     "expected at most 7 moving joints, found 8 in eight-joints.urdf; not named are j7: make each joint "
     "that does not move type=\"fixed\" in eight-joints.urdf"},
    {"missing-nodes.yaml", 1, "nodes", "expected this key, found none"},
    // Types.
    {"word-for-a-number.yaml", 3, "joints.rate_hz", "expected a number from 1 to 1000, found 'fast'"},
    {"quoted-number.yaml", 3, "joints.rate_hz", "expected a number from 1 to 1000, found '100'"},
    {"number-with-its-unit.yaml", 3, "nodes[0].sensors[0].timing_budget_ms", "found '33 ms'"},
    {"list-for-a-number.yaml", 3, "joints.rate_hz", "found a list of 1"},
    {"list-for-a-table.yaml", 2, "bus", "expected a table of keys, found a list of 2"},
    {"table-for-a-list.yaml", 2, "nodes", "expected a list, found a table"},
    {"fraction-for-a-whole-number.yaml", 3, "joints.node_id",
     "expected a whole number from 1 to 61, found '9.5'"},
    {"yes-for-true.yaml", 3, "nodes[0].sensors[0].applies_gain_factor",
     "expected true or false, found 'yes'"},
    {"two-numbers-for-a-position.yaml", 3, "nodes[0].sensors[0].pose.xyz_m",
     "expected a list of 3 numbers, found a list of 2"},
    {"name-with-a-space.yaml", 2, "name", "found 'my rig'"},
    {"name-with-a-slash.yaml", 2, "name", "that a folder can have, found 'lab/left': leave out / and .."},
    {"name-that-leaves-its-folder.yaml", 2, "name", "that a folder can have, found '..'"},
    {"node-name-that-leaves-its-folder.yaml", 3, "nodes[0].name", "that a folder can have, found 'board..7'"},
    {"board-name-that-leaves-its-folder.yaml", 5, "nodes[0].board.name",
     "that a folder can have, found '../a'"},
    {"node-name-of-a-dot.yaml", 3, "nodes[0].name", "that a folder can have, found '.'"},
    {"unknown-word.yaml", 3, "nodes[0].sensors[0].distance_mode",
     "expected short or medium or long, found 'far'"},
    // Numbers.
    {"nan.yaml", 3, "nodes[0].sensors[0].pose.xyz_m", "found 'nan'"},
    {"nan-of-yaml.yaml", 3, "joints.rate_hz", "found '.nan'"},
    {"infinity.yaml", 2, "T_map_base.xyz_m", "found 'inf'"},
    {"node-id-too-large.yaml", 3, "joints.node_id", "expected a whole number from 1 to 61, found '63'"},
    {"number-too-large-to-hold.yaml", 3, "joints.node_id", "found '99999999999999999999'"},
    {"metres-for-millimetres.yaml", 3, "nodes[0].sensors[0].pose.xyz_m", "is it written in millimetres?"},
    // Poses.
    {"non-unit-quaternion.yaml", 3, "nodes[0].sensors[0].pose.quaternion_wxyz", "found length 1.00498"},
    {"zero-quaternion.yaml", 3, "nodes[0].sensors[0].pose.quaternion_wxyz", "found length 0"},
    {"two-orientations.yaml", 2, "T_map_base", "expected one orientation, found 2"},
    {"no-orientation.yaml", 2, "T_map_base", "expected one orientation, found 0"},
    {"skewed-rotation.yaml", 4, "T_map_base.rotation_rows", "expected a rotation"},
    {"mirrored-rotation.yaml", 4, "T_map_base.rotation_rows", "right-handed"},
    {"sensor-looking-at-a-point.yaml", 3, "nodes[0].sensors[0].pose.looking_at_m", "expected a known key"},
    {"camera-looking-straight-down.yaml", 10, "camera.pose.looking_at_m", "give rpy_deg instead"},
    {"camera-depth-reversed.yaml", 11, "camera.depth_max_m", "expected more than depth_min_m"},
    {"camera-depth-beyond-its-images.yaml", 10, "camera.depth_max_m",
     "expected a number from 0 to 65.5, found '70'"},
    {"camera-centre-outside.yaml", 7, "camera.cx_px", "expected a number from 0 to 64, found '65'"},
    {"camera-lens-that-turns-back.yaml", 12, "camera.distortion",
     "found k1 -0.2297, k2 1.4766, p1 0.0005, p2 -0.0075, k3 -3.4194: pixel (0, 0) has none"},
    {"camera-lens-with-k4.yaml", 11, "camera.distortion.k4", "expected a known key"},
    {"camera-lens-as-a-list.yaml", 11, "camera.distortion", "expected a table of keys, found a list of 5"},
    {"camera-lens-coefficient-too-large.yaml", 11, "camera.distortion.p1",
     "expected a number from -1 to 1, found '7.5'"},
    {"data-set-scale-of-nothing.yaml", 11, "camera.data_set.depth_units_per_m",
     "expected a number from 1 to 1000000, found '0'"},
    {"data-set-scale-without-its-unit.yaml", 11, "camera.data_set.depth_units",
     "known here are depth_units_per_m, depth_no_value, pose_gap_max_ms"},
    {"data-set-no-value-beyond-16-bits.yaml", 12, "camera.data_set.depth_no_value",
     "expected a whole number from 0 to 65535, found '65536'"},
    {"data-set-pose-gap-in-seconds.yaml", 12, "camera.data_set.pose_gap_max_ms",
     "expected a number from 1 to 10000, found '0.2'"},
    {"reflex-of-a-fraction-of-a-millimetre.yaml", 3, "nodes[0].sensors[0].reflex_below_m",
     "expected whole millimetres, found 150.5 mm"},
    {"range-limits-reversed.yaml", 4, "range_limits.max_m", "expected more than min_m"},
    {"time-uncertainty-beyond-what-nodes-tell.yaml", 3, "range_limits.time_uncertainty_max_ms",
     "expected a number from 0.1 to 16, found '17'"},
    // References.
    {"sensor-on-a-missing-link.yaml", 3, "nodes[0].sensors[0].link",
     "expected a link of two-links.urdf at or below base, found 'gripper'"},
    {"sensor-above-the-base.yaml", 7, "nodes[0].sensors[0].link", "at or below plate, found 'arm'"},
    {"base-link-missing.yaml", 3, "robot.base_link", "found 'pelvis'"},
    {"ignored-link-missing.yaml", 3, "robot.links_ignored_by_sensors", "found 'gripper'"},
    {"padded-link-missing.yaml", 4, "robot.link_padding_m.gripper", "found 'gripper'"},
    {"padding-of-millimetres.yaml", 4, "robot.link_padding_m.arm",
     "expected a number from 0 to 0.5, found '20'"},
    {"attached-to-a-missing-link.yaml", 4, "robot.attached_capsules[0].link", "found 'gripper'"},
    {"attached-name-twice.yaml", 5, "robot.attached_capsules[1].name", "expected each name once"},
    {"attached-in-millimetres.yaml", 4, "robot.attached_capsules[0].radius_m",
     "expected a number from 0.001 to 1, found '20'"},
    {"without-body-missing.yaml", 3, "robot.links_without_body", "found 'gripper'"},
    {"without-body-twice.yaml", 3, "robot.links_without_body", "expected each link once, found 'arm' again"},
    {"without-body-above-the-base.yaml", 4, "robot.links_without_body",
     "expected a link at or below arm, found 'base'"},
    {"without-body-that-has-an-attached-capsule.yaml", 4, "robot.links_without_body",
     "found 'arm', which has the attached capsule 'tool'"},
    {"without-body-that-has-a-collision.yaml", 4, "robot.links_without_body",
     "found 'arm', which has a <collision> in ball-on-the-arm.urdf"},
    {"joint-missing.yaml", 3, "joints.names", "found 'wrist'; it has elbow"},
    {"joint-that-is-fixed.yaml", 3, "joints.names", "found 'bolts'"},
    {"joint-twice.yaml", 3, "joints.names", "expected each joint once"},
    {"joint-left-out.yaml", 3, "joints.names",
     "found none named elbow: its position would be unknown. Name it, or make each joint that does not move "
     "type=\"fixed\" in "},
    {"urdf-absent.yaml", 3, "robot.urdf", "no-such-robot.urdf"},
    {"board-absent.yaml", 5, "nodes[0].board", "no-such-board.yaml"},
    {"board-with-an-unknown-key.yaml", 5, "nodes[0].board.colour", "expected a known key"},
    // One of a kind.
    {"node-id-twice.yaml", 9, "nodes[1].node_id", "found node_id 1 again: nodes[0].node_id has it"},
    {"node-name-twice.yaml", 8, "nodes[1].name", "found name 'board' again"},
    {"node-id-of-the-joint-source.yaml", 3, "joints.node_id", "node 'board' has it"},
    {"sensor-name-twice.yaml", 8, "nodes[0].sensors[1].name", "found name 'front' again"},
    {"address-twice-on-a-bus.yaml", 8, "nodes[0].sensors[1].address",
     "found address 0x30 on bus 0 again: nodes[0].sensors[0].address has it"},
    {"xshut-line-twice.yaml", 8, "nodes[0].sensors[1].xshut_line", "found xshut_line 0 again"},
    {"address-of-power-on.yaml", 7, "nodes[0].sensors[0].address", "expected any address but 0x29"},
    {"address-below-range.yaml", 7, "nodes[0].sensors[0].address", "from 8 to 119, found '0x07'"},
    {"address-above-range.yaml", 7, "nodes[0].sensors[0].address", "from 8 to 119, found '0x78'"},
    {"address-in-8-bits.yaml", 7, "nodes[0].sensors[0].address", "from 8 to 119, found '0xA0'"},
    // The board's limits.
    {"bus-beyond-the-board.yaml", 7, "nodes[0].sensors[0].bus", "from 0 to 1, found '2'"},
    {"xshut-line-beyond-the-board.yaml", 7, "nodes[0].sensors[0].xshut_line", "from 0 to 3, found '4'"},
    {"too-many-sensors-on-a-node.yaml", 6, "nodes[0].sensors", "expected 1 to 3 sensors on a small, found 4"},
    {"too-many-sensors-on-a-bus.yaml", 9, "nodes[0].sensors[2].bus", "expected at most 2 sensors on a bus"},
    {"no-sensors.yaml", 6, "nodes[0].sensors", "expected 1 to 3 sensors on a small, found 0"},
    {"can-fd-on-a-classical-board.yaml", 8, "nodes[0].board", "old has classical CAN only"},
    {"data-ready-line-of-a-board-without.yaml", 6, "nodes[0].data_ready_buses", "small has none"},
    {"data-ready-line-beyond-the-board.yaml", 6, "nodes[0].data_ready_buses", "from 0 to 1, found '2'"},
    {"data-ready-line-twice.yaml", 6, "nodes[0].data_ready_buses", "expected each bus once, found 0 again"},
    {"data-ready-line-without-sensors.yaml", 6, "nodes[0].data_ready_buses", "found 1, which has none"},
    // Timing.
    {"period-too-short-for-the-budget.yaml", 3, "nodes[0].sensors[0].inter_measurement_ms",
     "expected at least timing_budget_ms + 5 = 38, found 37"},
    {"budget-not-in-the-table.yaml", 3, "nodes[0].sensors[0].timing_budget_ms",
     "expected one of 20, 33, 50, 100, 200 in long mode, found 25"},
    {"budget-of-short-mode-in-long-mode.yaml", 3, "nodes[0].sensors[0].timing_budget_ms",
     "in long mode, found 15"},
    {"budget-of-long-mode-in-medium-mode.yaml", 3, "nodes[0].sensors[0].timing_budget_ms",
     "expected one of 33, 50, 100, 200 in medium mode, found 20"},
    {"budget-over-200-ms.yaml", 3, "nodes[0].sensors[0].timing_budget_ms", "expected at most 200, found 500"},
    {"phase-beyond-the-period.yaml", 3, "nodes[0].sensors[0].phase_us", "from 0 to 49999, found '50000'"},
    // Zones.
    {"zone-off-the-array.yaml", 5, "nodes[0].sensors[0].zones[1].centre_spad", "found 8 x 8 about SPAD 128"},
    {"zone-too-narrow.yaml", 4, "nodes[0].sensors[0].zones[0].width_spads", "from 4 to 16, found '3'"},
    {"cone-as-a-full-angle.yaml", 3, "nodes[0].sensors[0].cone.half_angle_deg", "from 0.1 to 45, found '54'"},
    {"no-zones.yaml", 3, "nodes[0].sensors[0].zones", "expected 1 to 9 zones, found 0"},
    {"ten-zones.yaml", 3, "nodes[0].sensors[0].zones", "expected 1 to 9 zones, found 10"},
    {"zones-without-a-pause.yaml", 3, "nodes[0].sensors[0].inter_measurement_ms",
     "expected at least timing_budget_ms + 9 = 42 with 2 zones, found 41"},
    // Buses.
    {"odd-bitrate.yaml", 3, "bus.nominal_bitrate_bps",
     "expected one of 125000, 250000, 500000, 1000000, found 300000"},
    {"data-bitrate-on-classical-can.yaml", 3, "bus.data_bitrate_bps", "expected none with protocol can"},
    {"data-bitrate-missing.yaml", 2, "bus.data_bitrate_bps", "expected this key, found none"},
    {"i2c-overloaded.yaml", 7, "nodes[0].sensors",
     "found 73 % on bus 0: use a longer inter_measurement_ms, fewer sensors on this bus, or a faster i2c_hz"},
    {"i2c-overloaded-at-its-fastest-clock.yaml", 7, "nodes[0].sensors",
     "found 73 % on bus 0: use a longer inter_measurement_ms or fewer sensors on this bus"},
    {"can-overloaded.yaml", 2, "bus", "expected a CAN load of at most 70 %, found 7"},
};

class BrokenRig : public testing::TestWithParam<Broken> {};

TEST_P(BrokenRig, is_refused_with_file_line_key_and_remedy) {
    const auto& [file, line, key, words] = GetParam();
    const auto rig = read_rig(kData / file);
    ASSERT_FALSE(rig);
    EXPECT_EQ(rig.error().file.filename(), file);
    EXPECT_EQ(rig.error().line, line) << rig.error().message();
    EXPECT_EQ(rig.error().key, key) << rig.error().message();
    EXPECT_THAT(rig.error().message(), HasSubstr(words));
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenRig, testing::ValuesIn(kBroken), [](const auto& broken) {
    std::string name = std::filesystem::path(broken.param.file).stem().string();
    for (char& c : name) c = c == '-' ? '_' : c;
    return name;
});

TEST(BrokenRigs, every_defective_file_is_tested) {
    const std::set<std::string> elsewhere = {"one-sensor.yaml", "small-board.yaml",
                                             "extends-a-faulty-rig.yaml", "urdf-not-xml.yaml"};
    std::set<std::string> tested = elsewhere;
    for (const Broken& broken : kBroken) tested.insert(broken.file);
    for (const auto& entry : std::filesystem::directory_iterator(kData)) {
        if (entry.path().extension() == ".yaml") {
            EXPECT_TRUE(tested.contains(entry.path().filename().string())) << entry.path();
        }
    }
}

TEST(BrokenRigs, file_they_extend_is_correct) {
    const auto rig = read_rig(kData / "one-sensor.yaml");
    EXPECT_TRUE(rig) << rig.error().message();
}

TEST(BrokenRigs, fault_in_an_extended_file_is_reported_there) {
    const auto rig = read_rig(kData / "extends-a-faulty-rig.yaml");
    ASSERT_FALSE(rig);
    EXPECT_EQ(rig.error().file.filename(), "node-id-too-large.yaml");
    EXPECT_EQ(rig.error().line, 3);
}

TEST(BrokenRigs, fault_in_the_urdf_names_the_urdf) {
    const auto rig = read_rig(kData / "urdf-not-xml.yaml");
    ASSERT_FALSE(rig);
    EXPECT_EQ(rig.error().file.filename(), "not-xml.urdf");
}

TEST(BrokenRigs, absent_file_and_folder_are_refused_by_name) {
    EXPECT_THAT(read_rig(kData / "no-such.yaml").error().message(),
                HasSubstr("no-such.yaml: cannot be opened"));
    EXPECT_THAT(read_rig(kData).error().message(), HasSubstr("is a directory"));
}

TEST(BrokenRigs, file_over_the_limit_is_refused_unread) {
    const auto path = std::filesystem::path(testing::TempDir()) / "octoskin-huge-rig.yaml";
    std::ofstream(path) << std::string((1U << 20U) + 1, '#');
    EXPECT_THAT(read_rig(path).error().message(), HasSubstr("at most 262144 bytes"));
    std::filesystem::remove(path);
}

TEST(BrokenRigs, message_is_file_line_key_what) {
    const RigError error{"a/rig.yaml", 12, "nodes[0].name", "expected a name"};
    EXPECT_EQ(error.message(), "a/rig.yaml:12: nodes[0].name: expected a name");
    EXPECT_EQ((RigError{"a/rig.yaml", 0, "", "gone"}.message()), "a/rig.yaml: gone");
}

}  // namespace
}  // namespace octoskin::rig
