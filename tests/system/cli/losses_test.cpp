// Why little or nothing came into a map: the most frequent reason, where it began, and the exit code.
#include <gmock/gmock.h>

#include <functional>
#include <sstream>

#include "tests/support/data_set/written_data_set.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::Grey;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::what_is;
using testing_support::WrittenDataSet;

class Losses : public ProgramTest {
  protected:
    void SetUp() override { record_short("base"); }

    /// A copy of the recording with each line of its log replaced; an empty text takes the line out.
    void record_changed(const std::string& name,
                        const std::function<std::string(std::size_t, const std::string&)>& change) const {
        std::filesystem::copy(path("base"), path(name), std::filesystem::copy_options::recursive);
        std::istringstream lines(content(path("base/can.log")));
        std::string changed;
        std::size_t number = 0;
        for (std::string line; std::getline(lines, line);) {
            const std::string now = change(++number, line);
            changed += now + (now.empty() ? "" : "\n");
        }
        write(path(name) + "/can.log", changed);
    }
    [[nodiscard]] Said replay(const std::string& name) const { return octoskin("replay " + path(name)); }
};

/// The identifier of a line of a log: "181".
std::string id_of(const std::string& line) {
    const auto end = line.find('#');
    return line.substr(end - 3, 3);
}
bool is_joint_frame(const std::string& line) {
    return id_of(line) >= "181" && id_of(line) <= "1BE";
}
bool is_sync(const std::string& line) {
    return id_of(line) == "040";
}

TEST_F(Losses, a_sound_recording_ends_with_0_whatever_the_scene_explains) {
    const Said said = replay("base");
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, AllOf(HasSubstr("most as no_return"), Not(HasSubstr("loses"))));
}

TEST_F(Losses, of_lines_names_the_first_one_and_the_reason) {
    record_changed("lines", [](std::size_t number, std::string line) {
        if (number > 9 && number % 3 != 0) line.replace(line.find('#'), 1, "!");
        return line;
    });
    const Said said = replay("lines");
    EXPECT_EQ(said.exit_code, 1) << said.output;
    EXPECT_THAT(said.output, AllOf(HasSubstr("log lines: "), HasSubstr("most as line_identifier ("),
                                   HasSubstr("the first at can.log:10)")));
}

TEST_F(Losses, of_joint_samples_names_joint_value_and_limit_and_the_nodes_that_lose) {
    std::filesystem::copy(path("base"), path("limits"), std::filesystem::copy_options::recursive);
    const std::string urdf = content(path("base/robot.urdf"));
    const auto at = urdf.find("upper=\"", urdf.find("panda_joint1"));
    const auto end = urdf.find('"', at + 7);
    write(path("limits/robot.urdf"), urdf.substr(0, at + 7) + "-2" + urdf.substr(end));
    const Failure failure = failure_of("replay " + path("limits"));
    EXPECT_THAT(failure,
                fails_with(1, code_is(ErrorCode::no_content),
                           what_is(AllOf(HasSubstr("329 of 329"), HasSubstr("most as out_of_limits"))),
                           remedy_is("see the warnings above"), others_are("No map is written")));
    EXPECT_THAT(failure.output,
                AllOf(HasSubstr("joint samples: 329 of 329 are lost, most as out_of_limits (329, "
                                "the first at 1750000001.360135 s)"),
                      HasSubstr("panda_joint1 is "), HasSubstr("; its limits are -2.8973 to -2"),
                      HasSubstr("loses 329 of 329 joint samples, most as out_of_limits")));
    EXPECT_FALSE(std::filesystem::exists(path("limits/maps/fused.ot")));
}

TEST_F(Losses, of_slow_poses_has_the_gap_and_the_limit) {
    std::size_t frames = 0;
    record_changed("slow", [&](std::size_t, const std::string& line) {
        return is_joint_frame(line) && frames++ / 4 % 15 != 0 ? "" : line;
    });
    const Said said = replay("slow");
    EXPECT_EQ(said.exit_code, 1) << said.output;
    EXPECT_THAT(said.output, AllOf(HasSubstr("most as joints_missing ("), HasSubstr(" 150 ms apart"),
                                   HasSubstr("at most 100 ms are bridged")));
}

TEST_F(Losses, of_most_but_not_all_writes_the_map_and_ends_with_1) {
    // The joint states end a little after the motion has begun.
    record_changed("part", [](std::size_t number, const std::string& line) {
        return is_joint_frame(line) && number > 3'000 ? "" : line;
    });
    EXPECT_THAT(failure_of("replay " + path("part")),
                fails_with(1, code_is(ErrorCode::no_data),
                           what_is(AllOf(HasSubstr("readings"), HasSubstr("(joints_missing)")))));
    EXPECT_GT(content(path("part/maps/fused.ot")).size(), 1'000U);
    EXPECT_THAT(failure_of("explain 0.6 0 0.4 --recording " + path("part")),
                fails_with(1, code_is(ErrorCode::no_data)));
    EXPECT_THAT(failure_of("evaluate " + path("part") + " --json " + path("part.json")),
                fails_with(1, code_is(ErrorCode::no_data)));
    EXPECT_GT(content(path("part.json")).size(), 100U) << "the figures are written all the same";
}

TEST_F(Losses, where_nothing_came_into_the_map_the_reason_is_named_though_no_one_can_be_blamed) {
    record_changed("silent", [](std::size_t, const std::string& line) { return is_sync(line) ? "" : line; });
    const Said said = replay("silent");
    EXPECT_EQ(said.exit_code, 1) << said.output;
    EXPECT_THAT(said.output, AllOf(HasSubstr("most as no_host_time"),
                                   HasSubstr("Let a host send SYNC and FOLLOW_UP on the bus.")));
}

TEST_F(Losses, frames_of_other_devices_are_no_loss) {
    record_changed("shared", [](std::size_t, const std::string& line) {
        const std::string before = line.substr(0, line.find('#') - 3);
        return line + "\n" + before + "12345678#00\n" + before + "7FF#01";
    });
    const Said said = replay("shared");
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_THAT(said.output, HasSubstr("CAN frames: 8010 of 12015 are not used, most as foreign_format"));
    EXPECT_EQ(replay("base").exit_code, 0);
    EXPECT_EQ(content(path("shared/maps/fused.ot")), content(path("base/maps/fused.ot")));
}

/// A wall that fills the image.
void write_wall(const std::string& folder, std::uint16_t value, std::uint16_t step = 0) {
    WrittenDataSet data_set(folder);
    Grey wall{128, 106, std::vector<std::uint16_t>(std::size_t{128} * 106, value)};
    for (std::size_t i = 0; i < wall.values.size(); ++i)
        wall.values[i] = static_cast<std::uint16_t>(value + step * (i % 7));
    for (int i = 0; i < 3; ++i) {
        const std::string time = "1." + std::to_string(i) + "00000";
        data_set.add_image(time, wall);
        data_set.add_pose(time, "0.1 0.2 0.8 0.5 -0.5 0.5 -0.5");
    }
}

TEST_F(Losses, depth_in_millimetres_is_doubted_with_the_key_that_mends_it) {
    const std::string rig = " --rig " + source("tests/data/short/rig.yaml");
    const auto doubts = testing::HasSubstr("depth_units_per_m: 1000");
    write_wall(path("near"), 2'000);  // 2 m in millimetres: 0.4 m, nearer than depth_min_m
    const Said near = octoskin("replay " + path("near") + rig);
    EXPECT_EQ(near.exit_code, 1) << near.output;
    EXPECT_THAT(near.output, AllOf(doubts, HasSubstr("nearer than depth_min_m")));
    write_wall(path("wall"), 3'000);  // 3 m: 0.6 m
    EXPECT_THAT(octoskin("replay " + path("wall") + rig).output, doubts);
    write_wall(path("room"), 6'001, 13);  // 6 m and more: values of which most are no multiple of 5
    EXPECT_THAT(octoskin("replay " + path("room") + rig).output, AllOf(doubts, HasSubstr("multiples of 5")));
    write_wall(path("right"), 10'000, 5);  // 2 m at 5000 a metre
    const Said right = octoskin("replay " + path("right") + rig);
    EXPECT_EQ(right.exit_code, 0) << right.output;
    EXPECT_THAT(right.output, Not(doubts));
    write_wall(path("synthetic"), 12'003, 3);  // no camera's millimetres, but over 10 m if they were
    EXPECT_THAT(octoskin("replay " + path("synthetic") + rig).output, Not(doubts));
    write(path("mm.yaml"), "extends: " + source("tests/data/short/rig.yaml") +
                               "\ncamera: {data_set: {depth_units_per_m: 1000}}\n");
    const Said mended = octoskin("replay " + path("wall") + " --rig " + path("mm.yaml"));
    EXPECT_EQ(mended.exit_code, 0) << mended.output;
    EXPECT_THAT(mended.output, Not(doubts));
}

class ShippedRigs : public ProgramTest {};

TEST_F(ShippedRigs, still_end_with_0) {
    for (const auto& entry : std::filesystem::directory_iterator(source("hw/rigs"))) {
        const std::string rig = entry.path().string();
        const std::string name = entry.path().stem().string();
        if (entry.path().extension() != ".yaml") continue;
        const std::string out = path("rig_" + name);
        const std::string scenario = name.starts_with("cell")       ? "cell"
                                     : name.starts_with("cupboard") ? "cupboard"
                                     : name == "rods"               ? "rods"
                                     : name == "thin_bench"         ? "thin_bench"
                                                                    : "";
        const Said made = octoskin("simulate " + out + " --rig " + rig + " --scenario " +
                                   source(scenario.empty() ? "tests/data/short/scenario.yaml"
                                                           : "hw/worlds/" + scenario + ".scenario.yaml"));
        ASSERT_EQ(made.exit_code, 0) << made.output;
        const Said said = octoskin("replay " + out);
        EXPECT_EQ(said.exit_code, 0) << name << "\n" << said.output;
        EXPECT_THAT(said.output, Not(HasSubstr("are lost"))) << name;
    }
}

}  // namespace
}  // namespace octoskin
