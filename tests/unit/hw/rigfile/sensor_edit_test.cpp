// What was found of a sensor goes into the file that a person keeps, and nothing else of it changes.
#include "hw/rigfile/sensor_edit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin::rig {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::what_is;

const std::filesystem::path kRigs = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/rigs";

SensorEdit edit(const std::string& sensor, const std::string& key = "device_offset_mm",
                const std::string& value = "-17.25") {
    return {.node = "bench", .sensor = sensor, .key = key, .value = value};
}

TEST(SensorEdit, adds_the_key_after_the_name_and_keeps_the_rest) {
    const std::string text =
        "# a rig\n"
        "nodes:\n"
        "  - name: bench\n"
        "    sensors:\n"
        "      - name: front  # the one above the cable\n"
        "        bus: 0\n"
        "      - {name: 'left', bus: 0}\n";
    EXPECT_EQ(edited(text, edit("front")).value(),
              "# a rig\n"
              "nodes:\n"
              "  - name: bench\n"
              "    sensors:\n"
              "      - name: front  # the one above the cable\n"
              "        device_offset_mm: -17.25\n"
              "        bus: 0\n"
              "      - {name: 'left', bus: 0}\n");
    EXPECT_EQ(edited(text, edit("left")).value(),
              "# a rig\n"
              "nodes:\n"
              "  - name: bench\n"
              "    sensors:\n"
              "      - name: front  # the one above the cable\n"
              "        bus: 0\n"
              "      - {name: 'left', device_offset_mm: -17.25, bus: 0}\n");
}

TEST(SensorEdit, replaces_a_value_that_is_there) {
    const std::string text =
        "nodes:\n- name: bench\n  sensors:\n  - device_offset_mm: \"12.5\"  # of 2025\n    name: front";
    EXPECT_EQ(edited(text, edit("front")).value(),
              "nodes:\n- name: bench\n  sensors:\n  - device_offset_mm: -17.25  # of 2025\n    name: front");
    EXPECT_EQ(
        edited(text, edit("front", "crosstalk_kcps", "0.5")).value(),
        "nodes:\n- name: bench\n  sensors:\n  - device_offset_mm: \"12.5\"  # of 2025\n    name: front\n"
        "    crosstalk_kcps: 0.5");
}

TEST(SensorEdit, finds_nothing_where_nothing_is) {
    for (const char* text : {"", "nodes: 3", "nodes: [{name: bench}]", "nodes: [{name: bench, sensors: [3]}]",
                             "nodes: [{name: other, sensors: [{name: front}]}]", "{", "- a\n- b"})
        EXPECT_EQ(edited(text, edit("front")), std::nullopt) << text;
}

class ShippedRig : public testing::Test {
  protected:
    /// As `edit_sensor` with a plain way to save.
    Result<std::filesystem::path, Error> change(const std::filesystem::path& file, const SensorEdit& edit) {
        return edit_sensor(file, edit, [this](const FilePlace& place, const std::string& text) {
            if (saves_left_-- <= 0) return std::optional<std::string>("no ink");
            std::ofstream(place.shown(), std::ios::binary) << text;
            return std::optional<std::string>();
        });
    }
    int saves_left_ = 100;
    ShippedRig() {
        for (const char* folder : {"rigs", "boards", "robots"})
            std::filesystem::copy(kRigs.parent_path() / folder, folder_.path() / folder,
                                  std::filesystem::copy_options::recursive);
    }
    testing_support::ScratchFolder folder_;
};

TEST_F(ShippedRig, gets_the_value_and_keeps_all_else) {
    const auto file = folder_ / "rigs/bench_one_board.yaml";
    const auto before = read_rig(file);
    ASSERT_TRUE(before);
    ASSERT_TRUE(change(file, edit("back")));
    ASSERT_TRUE(change(file, edit("back", "crosstalk_kcps", "1.001953")));
    auto after = read_rig(file);
    ASSERT_TRUE(after) << after.error().message();
    const SensorConfig& changed = after->nodes[0].config.sensors[2];
    EXPECT_TRUE(changed.has_offset);
    EXPECT_EQ(changed.offset_quarter_mm, -69);
    EXPECT_EQ(changed.crosstalk_raw, 513);
    after->nodes[0].config.sensors[2] = before->nodes[0].config.sensors[2];
    EXPECT_EQ(rig_hash(*after), rig_hash(*before));
}

TEST_F(ShippedRig, of_another_that_it_extends_is_changed_where_the_sensor_is_written) {
    const auto base = folder_ / "rigs/bench_one_board.yaml";
    const auto heir = folder_.write("rigs/heir.yaml", "extends: bench_one_board.yaml\nname: heir\n");
    const auto changed = change(heir, edit("left"));
    ASSERT_TRUE(changed) << changed.error().message();
    EXPECT_EQ(changed->filename(), base.filename());
    EXPECT_EQ(read_rig(heir)->nodes[0].config.sensors[1].offset_quarter_mm, -69);
}

TEST_F(ShippedRig, is_put_back_if_it_would_not_be_a_rig) {
    const auto file = folder_ / "rigs/bench_one_board.yaml";
    const std::string before = testing_support::ScratchFolder::read(file);
    EXPECT_FALSE(change(file, edit("back", "device_offset_mm", "4000")));
    EXPECT_FALSE(change(file, edit("back", "link", "panda_link7"))) << "more than its device settings";
    EXPECT_FALSE(change(file, edit("top")));
    EXPECT_EQ(testing_support::ScratchFolder::read(file), before);
}

TEST_F(ShippedRig, is_not_changed_for_a_sensor_that_only_a_file_beneath_it_still_has) {
    const auto base = folder_ / "rigs/bench_one_board.yaml";
    const std::string before = testing_support::ScratchFolder::read(base);
    const auto heir = folder_.write("rigs/heir.yaml",
                                    "extends: bench_one_board.yaml\nname: heir\nnodes:\n- name: bench\n"
                                    "  node_id: 1\n  board: ../boards/nucleo_g474re.yaml\n  sensors:\n"
                                    "  - {name: front, bus: 0, xshut_line: 0, address: 0x30, "
                                    "pose: {xyz_m: [0, 0, 0], rpy_deg: [0, 0, 0]}}\n");
    ASSERT_TRUE(read_rig(heir)) << read_rig(heir).error().message();
    const auto refused = change(heir, edit("back"));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error(),
                AllOf(code_is(ErrorCode::unknown_name), file_is("heir.yaml"),
                      what_is(AllOf(HasSubstr("sensor 'back'"), HasSubstr("node 'bench'")))));
    EXPECT_EQ(testing_support::ScratchFolder::read(base), before);
    ASSERT_TRUE(change(heir, edit("front")));
    EXPECT_EQ(testing_support::ScratchFolder::read(base), before);
}

TEST_F(ShippedRig, that_cannot_be_saved_or_put_back_is_told_with_the_reason) {
    const auto file = folder_ / "rigs/bench_one_board.yaml";
    const std::string before = testing_support::ScratchFolder::read(file);
    saves_left_ = 0;
    EXPECT_THAT(change(file, edit("back")).error(),
                AllOf(code_is(ErrorCode::system_error), file_is(file.filename()), what_is("no ink")));
    EXPECT_EQ(testing_support::ScratchFolder::read(file), before);
    saves_left_ = 1;
    EXPECT_THAT(change(file, edit("back", "device_offset_mm", "4000")).error(),
                AllOf(code_is(ErrorCode::system_error), file_is(file.filename()),
                      what_is("was changed and cannot be put back: no ink")));
}

}  // namespace
}  // namespace octoskin::rig
