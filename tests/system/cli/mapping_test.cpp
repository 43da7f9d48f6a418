// octoskin mapping of a rig: how thin an object may be to be kept.
#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing::Not;

class MappingCommandTest : public ProgramTest {
  protected:
    [[nodiscard]] static Said mapping(const std::string& configuration, const std::string& rig) {
        return octoskin("mapping " + configuration + " --rig " + rig);
    }
    /// Words of the table's rows; a row begins with a depth.
    [[nodiscard]] static std::vector<std::vector<std::string>> rows_of(const std::string& output) {
        std::vector<std::vector<std::string>> rows;
        std::istringstream lines(output);
        for (std::string line; std::getline(lines, line);) {
            std::istringstream words(line);
            std::vector<std::string> row;
            for (std::string word; words >> word;) row.push_back(word);
            if (row.size() == 8 && row[0] == "#" && row[1].find('.') == 1) rows.push_back(row);
        }
        return rows;
    }
};

// 365 pixels a radian, 10 images a second; the columns are depth, pixel, noise, thinnest after 1 and after 10
// images, and the distances to what is behind.
TEST_F(MappingCommandTest, tells_the_thinnest_object_at_each_depth_of_the_rigs_camera) {
    const Said said = mapping("denoised", source("hw/rigs/experiment.yaml"));
    ASSERT_EQ(said.exit_code, 0) << said.output;
    const auto rows = rows_of(said.output);
    ASSERT_EQ(rows.size(), 9U) << said.output;
    EXPECT_EQ(rows.front()[1], "0.50");
    EXPECT_EQ(rows.back()[1], "4.50");
    const auto& at_two_metres = rows[3];
    EXPECT_EQ(at_two_metres,
              (std::vector<std::string>{"#", "2.00", "5.5", "30.0", "19.1", "8.2", "110.2", "34.9"}));
    EXPECT_EQ(rows.back()[4], "none");
    for (const auto& row : rows) EXPECT_LE(std::stod(row[2]), std::stod(row[5])) << "never less than a pixel";
}

TEST_F(MappingCommandTest, is_of_the_mappings_own_noise_and_voxels_and_can_be_read_back) {
    write(path("fine.yaml"),
          "map: {resolution_m: 0.02}\ndepth_denoiser: {noise_m: 0.0012, noise_per_m: 0.0019}\n");
    const Said said = mapping(path("fine.yaml"), source("hw/rigs/experiment.yaml"));
    const auto rows = rows_of(said.output);
    ASSERT_EQ(rows.size(), 9U) << said.output;
    EXPECT_EQ(rows[3][3], "6.1") << "1.2 mm + 1.9 mm * 1.6^2";
    EXPECT_THAT(said.output, HasSubstr("(20.0 mm)"));
    write(path("printed.yaml"), said.output);
    EXPECT_EQ(octoskin("mapping " + path("printed.yaml")).output,
              octoskin("mapping " + path("fine.yaml")).output);
}

TEST_F(MappingCommandTest, of_a_rig_without_camera_or_another_update_says_so) {
    const Said blind = mapping("denoised", source("hw/rigs/one_board_17.yaml"));
    EXPECT_EQ(blind.exit_code, 0) << blind.output;
    EXPECT_TRUE(rows_of(blind.output).empty());
    EXPECT_THAT(blind.output, HasSubstr("no camera"));
    const Said robust = mapping("robust", source("hw/rigs/experiment.yaml"));
    EXPECT_EQ(robust.exit_code, 0) << robust.output;
    EXPECT_TRUE(rows_of(robust.output).empty());
    EXPECT_THAT(octoskin("mapping").output, Not(HasSubstr("hinnest")));
    EXPECT_EQ(octoskin("mapping --rig " + path("none.yaml")).exit_code, 66);
    EXPECT_EQ(octoskin("mapping --keys --rig " + source("hw/rigs/experiment.yaml")).exit_code, 64);
}

}  // namespace
}  // namespace octoskin
