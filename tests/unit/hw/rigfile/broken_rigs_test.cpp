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
#include "tests/support/errors/error_fields.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

const std::filesystem::path kData = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/rigs";

struct Broken {
    const char* file;
    int line;
    const char* key;
    ErrorCode code;
    std::string value;
    const char* also = "";  ///< part of the rule or of the remedy: a limit, or what a user must write
    friend std::ostream& operator<<(std::ostream& out, const Broken& broken) { return out << broken.file; }
};

const Broken kBroken[] = {
    // What is no rig at all.
    {"not-yaml.yaml", 3, "", ErrorCode::bad_syntax, "", "'[' above is not closed"},
    {"empty.yaml", 1, "", ErrorCode::wrong_type, "", "a table of keys at the top"},
    {"list-at-top.yaml", 1, "", ErrorCode::wrong_type, "", "a table of keys at the top"},
    {"two-documents.yaml", 3, "", ErrorCode::unsupported, "a second"},
    {"repeated-key.yaml", 4, "name", ErrorCode::duplicate, "it again (first at line 2)"},
    {"anchor.yaml", 2, "", ErrorCode::unsupported, "", "anchors (&name)"},
    {"tag.yaml", 2, "", ErrorCode::unsupported, "", "remove '!text'"},
    {"nested-too-deep.yaml", 2, "", ErrorCode::limit_exceeded, "", "at most 16 levels"},
    {"list-as-key.yaml", 2, "", ErrorCode::bad_syntax, "a list or table"},
    {"extends-itself.yaml", 0, "extends", ErrorCode::limit_exceeded, "more", "is there a circle?"},
    {"extends-absent.yaml", 2, "extends", ErrorCode::not_found,
     "none at '" + (kData / "no-such-rig.yaml").string() + "'"},
    // Keys.
    {"unknown-key.yaml", 2, "cammera", ErrorCode::unknown_key, "", "did you mean camera?"},
    {"unknown-key-like-none.yaml", 2, "wavelength_nm", ErrorCode::unknown_key, "",
     "known here are name, robot, T_map_base, bus"},
    {"millimetres-in-the-key.yaml", 3, "nodes[0].sensors[0].pose.xyz_mm", ErrorCode::unknown_key, "",
     "did you mean nodes[0].sensors[0].pose.xyz_m? (the unit is part of the name"},
    {"key-without-its-unit.yaml", 3, "nodes[0].sensors[0].timing_budget", ErrorCode::unknown_key, "",
     "did you mean nodes[0].sensors[0].timing_budget_ms?"},
    {"unknown-key-like-extends.yaml", 1, "extend", ErrorCode::unknown_key, "", "did you mean extends?"},
    {"missing-key.yaml", 2, "bus.nominal_bitrate_bps", ErrorCode::missing_key, ""},
    {"sensor-in-a-replaced-list-lacks-a-key.yaml", 7, "nodes[0].sensors[0].address", ErrorCode::missing_key,
     "", "add it (a list replaces the inherited one as a whole)"},
    {"no-nodes.yaml", 2, "nodes", ErrorCode::limit_exceeded, "0", "1 to 61"},
    {"two-rows-of-a-rotation.yaml", 4, "T_map_base.rotation_rows", ErrorCode::wrong_type, "a list of 2",
     "3 rows"},
    {"list-for-the-padding.yaml", 3, "robot.link_padding_m", ErrorCode::wrong_type, "a list of 1",
     "link names and metres"},
    {"more-joints-than-a-sample-holds.yaml", 7, "joints.names", ErrorCode::limit_exceeded,
     "8 in eight-joints.urdf", "a list of sources, each with up to seven"},
    {"seven-of-eight-joints.yaml", 7, "joints.names", ErrorCode::missing_key, "none named j7",
     "name it in another source (`joints` may be a list, each with up to seven)"},
    {"missing-nodes.yaml", 1, "nodes", ErrorCode::missing_key, ""},
    // Types.
    {"word-for-a-number.yaml", 3, "joints.rate_hz", ErrorCode::wrong_type, "'fast'", "from 1 to 1000"},
    {"quoted-number.yaml", 3, "joints.rate_hz", ErrorCode::wrong_type, "'100'", "leave out the quotes"},
    {"number-with-its-unit.yaml", 3, "nodes[0].sensors[0].timing_budget_ms", ErrorCode::wrong_type,
     "'33 ms'"},
    {"list-for-a-number.yaml", 3, "joints.rate_hz", ErrorCode::wrong_type, "a list of 1"},
    {"list-for-a-table.yaml", 2, "bus", ErrorCode::wrong_type, "a list of 2"},
    {"table-for-a-list.yaml", 2, "nodes", ErrorCode::wrong_type, "a table"},
    {"fraction-for-a-whole-number.yaml", 3, "joints.node_id", ErrorCode::wrong_type, "'9.5'",
     "a whole number from 1 to 61"},
    {"yes-for-true.yaml", 3, "nodes[0].sensors[0].applies_gain_factor", ErrorCode::wrong_type, "'yes'",
     "true or false"},
    {"two-numbers-for-a-position.yaml", 3, "nodes[0].sensors[0].pose.xyz_m", ErrorCode::wrong_type,
     "a list of 2", "3 numbers"},
    {"name-with-a-space.yaml", 2, "name", ErrorCode::bad_name, "'my rig'", "letters, digits or _ - . /"},
    {"name-with-a-slash.yaml", 2, "name", ErrorCode::bad_name, "'lab/left'", "leave out / and .."},
    {"name-that-leaves-its-folder.yaml", 2, "name", ErrorCode::bad_name, "'..'", "that a folder can have"},
    {"node-name-that-leaves-its-folder.yaml", 3, "nodes[0].name", ErrorCode::bad_name, "'board..7'",
     "that a folder can have"},
    {"board-name-that-leaves-its-folder.yaml", 5, "nodes[0].board.name", ErrorCode::bad_name, "'../a'",
     "that a folder can have"},
    {"node-name-of-a-dot.yaml", 3, "nodes[0].name", ErrorCode::bad_name, "'.'", "that a folder can have"},
    {"unknown-word.yaml", 3, "nodes[0].sensors[0].distance_mode", ErrorCode::unknown_word, "'far'",
     "short or medium or long"},
    // Numbers.
    {"nan.yaml", 3, "nodes[0].sensors[0].pose.xyz_m", ErrorCode::out_of_range, "'nan'"},
    {"nan-of-yaml.yaml", 3, "joints.rate_hz", ErrorCode::wrong_type, "'.nan'"},
    {"infinity.yaml", 2, "T_map_base.xyz_m", ErrorCode::out_of_range, "'inf'"},
    {"node-id-too-large.yaml", 3, "joints.node_id", ErrorCode::out_of_range, "'63'", "from 1 to 61"},
    {"number-too-large-to-hold.yaml", 3, "joints.node_id", ErrorCode::wrong_type, "'99999999999999999999'"},
    {"metres-for-millimetres.yaml", 3, "nodes[0].sensors[0].pose.xyz_m", ErrorCode::out_of_range,
     "(50, 0, 20)", "is it written in millimetres?"},
    // Poses.
    {"non-unit-quaternion.yaml", 3, "nodes[0].sensors[0].pose.quaternion_wxyz", ErrorCode::bad_value,
     "length 1.004987562112089"},
    {"zero-quaternion.yaml", 3, "nodes[0].sensors[0].pose.quaternion_wxyz", ErrorCode::bad_value, "length 0"},
    {"two-orientations.yaml", 2, "T_map_base", ErrorCode::conflict, "2", "rpy_deg or quaternion_wxyz"},
    {"no-orientation.yaml", 2, "T_map_base", ErrorCode::missing_key, "0", "rpy_deg or quaternion_wxyz"},
    {"skewed-rotation.yaml", 4, "T_map_base.rotation_rows", ErrorCode::bad_value, "", "a rotation"},
    {"mirrored-rotation.yaml", 4, "T_map_base.rotation_rows", ErrorCode::bad_value, "", "right-handed"},
    {"sensor-looking-at-a-point.yaml", 3, "nodes[0].sensors[0].pose.looking_at_m", ErrorCode::unknown_key, "",
     "known here are xyz_m, rpy_deg, quaternion_wxyz, rotation_rows"},
    {"camera-looking-straight-down.yaml", 10, "camera.pose.looking_at_m", ErrorCode::bad_value, "",
     "give rpy_deg instead"},
    {"camera-topic-without-its-slash.yaml", 10, "camera.device", ErrorCode::bad_value, "'ros:depth/image'",
     "which begins with /"},
    {"camera-topic-without-ros.yaml", 10, "camera.device", ErrorCode::bad_value, "'/depth/image'",
     "write ros:/depth/image"},
    {"camera-pose-of-frames.yaml", 11, "camera.pose", ErrorCode::bad_value, "'tf'",
     "octoskin bridge pose --rig "},
    {"camera-depth-reversed.yaml", 11, "camera.depth_max_m", ErrorCode::out_of_range, "4",
     "more than depth_min_m"},
    {"camera-depth-beyond-its-images.yaml", 10, "camera.depth_max_m", ErrorCode::out_of_range, "'70'",
     "from 0 to 65.5"},
    {"camera-centre-outside.yaml", 7, "camera.cx_px", ErrorCode::out_of_range, "'65'", "from 0 to 64"},
    {"camera-lens-that-turns-back.yaml", 12, "camera.distortion", ErrorCode::bad_value,
     "k1 -0.2297, k2 1.4766, p1 0.0005, p2 -0.0075, k3 -3.4194", "pixel (0, 0) has none"},
    {"camera-lens-with-k4.yaml", 11, "camera.distortion.k4", ErrorCode::unknown_key, ""},
    {"camera-lens-as-a-list.yaml", 11, "camera.distortion", ErrorCode::wrong_type, "a list of 5"},
    {"camera-lens-coefficient-too-large.yaml", 11, "camera.distortion.p1", ErrorCode::out_of_range, "'7.5'",
     "from -1 to 1"},
    {"data-set-scale-of-nothing.yaml", 11, "camera.data_set.depth_units_per_m", ErrorCode::out_of_range,
     "'0'", "from 1 to 1000000"},
    {"data-set-scale-without-its-unit.yaml", 11, "camera.data_set.depth_units", ErrorCode::unknown_key, "",
     "known here are depth_units_per_m, depth_no_value, pose_gap_max_ms"},
    {"data-set-no-value-beyond-16-bits.yaml", 12, "camera.data_set.depth_no_value", ErrorCode::out_of_range,
     "'65536'", "from 0 to 65535"},
    {"data-set-pose-gap-in-seconds.yaml", 12, "camera.data_set.pose_gap_max_ms", ErrorCode::out_of_range,
     "'0.2'", "from 1 to 10000"},
    {"reflex-of-a-fraction-of-a-millimetre.yaml", 3, "nodes[0].sensors[0].reflex_below_m",
     ErrorCode::bad_value, "150.5 mm", "whole millimetres"},
    {"range-limits-reversed.yaml", 4, "range_limits.max_m", ErrorCode::out_of_range, "1", "more than min_m"},
    {"time-uncertainty-beyond-what-nodes-tell.yaml", 3, "range_limits.time_uncertainty_max_ms",
     ErrorCode::out_of_range, "'17'", "from 0.1 to 16"},
    // References.
    {"sensor-on-a-missing-link.yaml", 3, "nodes[0].sensors[0].link", ErrorCode::unknown_name, "'gripper'",
     "two-links.urdf at or below base"},
    {"sensor-above-the-base.yaml", 7, "nodes[0].sensors[0].link", ErrorCode::unknown_name, "'arm'",
     "at or below plate"},
    {"base-link-missing.yaml", 3, "robot.base_link", ErrorCode::unknown_name, "'pelvis'"},
    {"ignored-link-missing.yaml", 3, "robot.links_ignored_by_sensors", ErrorCode::unknown_name, "'gripper'"},
    {"padded-link-missing.yaml", 4, "robot.link_padding_m.gripper", ErrorCode::unknown_name, "'gripper'"},
    {"padding-of-millimetres.yaml", 4, "robot.link_padding_m.arm", ErrorCode::out_of_range, "'20'",
     "from 0 to 0.5"},
    {"attached-to-a-missing-link.yaml", 4, "robot.attached_capsules[0].link", ErrorCode::unknown_name,
     "'gripper'"},
    {"attached-name-twice.yaml", 5, "robot.attached_capsules[1].name", ErrorCode::duplicate, "'tool' again"},
    {"attached-in-millimetres.yaml", 4, "robot.attached_capsules[0].radius_m", ErrorCode::out_of_range,
     "'20'", "from 0.001 to 1"},
    {"without-body-missing.yaml", 3, "robot.links_without_body", ErrorCode::unknown_name, "'gripper'"},
    {"without-body-twice.yaml", 3, "robot.links_without_body", ErrorCode::duplicate, "'arm' again"},
    {"without-body-above-the-base.yaml", 4, "robot.links_without_body", ErrorCode::unknown_name, "'base'",
     "at or below arm"},
    {"without-body-that-has-an-attached-capsule.yaml", 4, "robot.links_without_body", ErrorCode::conflict,
     "'arm', which has the attached capsule 'tool'"},
    {"without-body-that-has-a-collision.yaml", 4, "robot.links_without_body", ErrorCode::conflict,
     "'arm', which has a <collision> in ball-on-the-arm.urdf"},
    {"joint-missing.yaml", 3, "joints.names", ErrorCode::unknown_name, "'wrist'", "it has elbow"},
    {"joint-that-is-fixed.yaml", 3, "joints.names", ErrorCode::unknown_name, "'bolts'"},
    {"joint-twice.yaml", 3, "joints.names", ErrorCode::duplicate, "'elbow' again"},
    {"joint-left-out.yaml", 3, "joints.names", ErrorCode::missing_key, "none named elbow",
     "type=\"fixed\" in two-links.urdf"},
    {"urdf-absent.yaml", 3, "robot.urdf", ErrorCode::not_found,
     "none at '" + (kData / "no-such-robot.urdf").string() + "'"},
    {"board-absent.yaml", 5, "nodes[0].board", ErrorCode::not_found,
     "none at '" + (kData / "no-such-board.yaml").string() + "'"},
    {"board-with-an-unknown-key.yaml", 5, "nodes[0].board.colour", ErrorCode::unknown_key, "",
     "known here are name, board_type"},
    // One of a kind.
    {"node-id-twice.yaml", 9, "nodes[1].node_id", ErrorCode::duplicate, "node_id 1 again",
     "nodes[0].node_id"},
    {"node-name-twice.yaml", 8, "nodes[1].name", ErrorCode::duplicate, "name 'board' again", "nodes[0].name"},
    {"node-id-of-the-joint-source.yaml", 3, "joints.node_id", ErrorCode::duplicate, "1", "node 'board'"},
    {"sensor-name-twice.yaml", 8, "nodes[0].sensors[1].name", ErrorCode::duplicate, "name 'front' again",
     "nodes[0].sensors[0].name"},
    {"address-twice-on-a-bus.yaml", 8, "nodes[0].sensors[1].address", ErrorCode::duplicate,
     "address 0x30 on bus 0 again", "nodes[0].sensors[0].address"},
    {"xshut-line-twice.yaml", 8, "nodes[0].sensors[1].xshut_line", ErrorCode::duplicate, "xshut_line 0 again",
     "nodes[0].sensors[0].xshut_line"},
    {"address-of-power-on.yaml", 7, "nodes[0].sensors[0].address", ErrorCode::bad_value, "0x29"},
    {"address-below-range.yaml", 7, "nodes[0].sensors[0].address", ErrorCode::out_of_range, "'0x07'",
     "from 8 to 119"},
    {"address-above-range.yaml", 7, "nodes[0].sensors[0].address", ErrorCode::out_of_range, "'0x78'",
     "from 8 to 119"},
    {"address-in-8-bits.yaml", 7, "nodes[0].sensors[0].address", ErrorCode::out_of_range, "'0xA0'",
     "from 8 to 119"},
    // The board's limits.
    {"bus-beyond-the-board.yaml", 7, "nodes[0].sensors[0].bus", ErrorCode::out_of_range, "'2'",
     "from 0 to 1"},
    {"xshut-line-beyond-the-board.yaml", 7, "nodes[0].sensors[0].xshut_line", ErrorCode::out_of_range, "'4'",
     "from 0 to 3"},
    {"too-many-sensors-on-a-node.yaml", 6, "nodes[0].sensors", ErrorCode::limit_exceeded, "4",
     "1 to 3 sensors on a small"},
    {"too-many-sensors-on-a-bus.yaml", 9, "nodes[0].sensors[2].bus", ErrorCode::limit_exceeded,
     "more on bus 1", "at most 2 sensors on a bus"},
    {"no-sensors.yaml", 6, "nodes[0].sensors", ErrorCode::limit_exceeded, "0", "1 to 3 sensors on a small"},
    {"can-fd-on-a-classical-board.yaml", 8, "nodes[0].board", ErrorCode::conflict,
     "old, which has classical CAN only"},
    {"data-ready-line-of-a-board-without.yaml", 6, "nodes[0].data_ready_buses", ErrorCode::conflict,
     "small, which has none"},
    {"data-ready-line-beyond-the-board.yaml", 6, "nodes[0].data_ready_buses", ErrorCode::out_of_range, "'2'",
     "from 0 to 1"},
    {"data-ready-line-twice.yaml", 6, "nodes[0].data_ready_buses", ErrorCode::duplicate, "0 again"},
    {"data-ready-line-without-sensors.yaml", 6, "nodes[0].data_ready_buses", ErrorCode::bad_value,
     "1, which has none"},
    // Timing.
    {"period-too-short-for-the-budget.yaml", 3, "nodes[0].sensors[0].inter_measurement_ms",
     ErrorCode::conflict, "37", "timing_budget_ms + 5 = 38"},
    {"budget-not-in-the-table.yaml", 3, "nodes[0].sensors[0].timing_budget_ms", ErrorCode::out_of_range, "25",
     "20, 33, 50, 100, 200 in long mode"},
    {"budget-of-short-mode-in-long-mode.yaml", 3, "nodes[0].sensors[0].timing_budget_ms",
     ErrorCode::out_of_range, "15", "in long mode"},
    {"budget-of-long-mode-in-medium-mode.yaml", 3, "nodes[0].sensors[0].timing_budget_ms",
     ErrorCode::out_of_range, "20", "33, 50, 100, 200 in medium mode"},
    {"budget-over-200-ms.yaml", 3, "nodes[0].sensors[0].timing_budget_ms", ErrorCode::out_of_range, "500",
     "at most 200"},
    {"phase-beyond-the-period.yaml", 3, "nodes[0].sensors[0].phase_us", ErrorCode::out_of_range, "'50000'",
     "from 0 to 49999"},
    // Zones.
    {"zone-off-the-array.yaml", 5, "nodes[0].sensors[0].zones[1].centre_spad", ErrorCode::out_of_range,
     "8 x 8 about SPAD 128"},
    {"zone-too-narrow.yaml", 4, "nodes[0].sensors[0].zones[0].width_spads", ErrorCode::out_of_range, "'3'",
     "from 4 to 16"},
    {"cone-as-a-full-angle.yaml", 3, "nodes[0].sensors[0].cone.half_angle_deg", ErrorCode::out_of_range,
     "'54'", "from 0.1 to 45"},
    {"no-zones.yaml", 3, "nodes[0].sensors[0].zones", ErrorCode::limit_exceeded, "0", "1 to 9 zones"},
    {"ten-zones.yaml", 3, "nodes[0].sensors[0].zones", ErrorCode::limit_exceeded, "10", "1 to 9 zones"},
    {"zones-without-a-pause.yaml", 3, "nodes[0].sensors[0].inter_measurement_ms", ErrorCode::conflict, "41",
     "timing_budget_ms + 9 = 42 with 2 zones"},
    // Buses.
    {"odd-bitrate.yaml", 3, "bus.nominal_bitrate_bps", ErrorCode::out_of_range, "300000",
     "125000, 250000, 500000, 1000000"},
    {"data-bitrate-on-classical-can.yaml", 3, "bus.data_bitrate_bps", ErrorCode::conflict, "",
     "protocol can"},
    {"data-bitrate-missing.yaml", 2, "bus.data_bitrate_bps", ErrorCode::missing_key, ""},
    {"i2c-overloaded.yaml", 7, "nodes[0].sensors", ErrorCode::overload, "73 % on bus 0",
     "a longer inter_measurement_ms, fewer sensors on this bus, or a faster i2c_hz"},
    {"i2c-overloaded-at-its-fastest-clock.yaml", 7, "nodes[0].sensors", ErrorCode::overload, "73 % on bus 0",
     "a longer inter_measurement_ms or fewer sensors on this bus"},
    {"can-overloaded.yaml", 2, "bus", ErrorCode::overload, "71.1 % in the worst case", "at most 70 %"},
};

class BrokenRig : public testing::TestWithParam<Broken> {};

TEST_P(BrokenRig, is_refused_with_file_line_key_and_remedy) {
    const auto& [file, line, key, code, value, also] = GetParam();
    const auto rig = read_rig(kData / file);
    ASSERT_FALSE(rig);
    const Error& error = rig.error();
    EXPECT_THAT(error, AllOf(file_is(file), line_is(line), key_is(key), code_is(code), value_is(value)));
    EXPECT_THAT(error, AnyOf(what_is(HasSubstr(also)), remedy_is(HasSubstr(also))));
    EXPECT_TRUE(has_its_fields(error));
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
    EXPECT_THAT(read_rig(kData / "no-such.yaml").error(),
                AllOf(code_is(ErrorCode::not_found), file_is("no-such.yaml")));
    EXPECT_THAT(read_rig(kData).error(), AllOf(code_is(ErrorCode::wrong_kind_of_file), file_is("rigs"),
                                               what_is(HasSubstr("a directory"))));
}

TEST(BrokenRigs, file_over_the_limit_is_refused_unread) {
    const auto path = std::filesystem::path(testing::TempDir()) / "octoskin-huge-rig.yaml";
    std::ofstream(path) << std::string((1U << 20U) + 1, '#');
    EXPECT_THAT(read_rig(path).error(), AllOf(code_is(ErrorCode::too_large), what_is(HasSubstr("262144"))));
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace octoskin::rig
