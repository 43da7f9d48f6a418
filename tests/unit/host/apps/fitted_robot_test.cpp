#include "host/apps/recording/fitted_robot.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "host/apps/recording/given_rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

namespace fs = std::filesystem;

class FittedRobot : public testing::Test {
  protected:
    FittedRobot() {
        ::setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
        folder_.write("arm.stl", testing_support::wedge_stl());
        rig_.base_link = "base";
        rig_.urdf = folder_.write("arm.urdf", robot("0.2"));
    }
    ~FittedRobot() override { ::unsetenv("XDG_CACHE_HOME"); }

    static std::string robot(const std::string& scale) {
        return "<robot name=\"r\"><link name=\"base\"><collision><geometry><mesh filename=\"arm.stl\" "
               "scale=\"" +
               scale + " 0.1 0.1\"/></geometry></collision></link></robot>";
    }
    [[nodiscard]] std::size_t kept() const {
        std::error_code none;
        std::size_t count = 0;
        for (fs::directory_iterator at(fitted_robot_folder(), none); at != fs::directory_iterator(); ++at)
            ++count;
        return count;
    }

    testing_support::ScratchFolder folder_;
    rig::Rig rig_;
};

TEST_F(FittedRobot, is_made_once_and_then_used_also_by_a_daemon) {
    const auto refused = use_fitted_robot(rig_, RobotFitting::kept_only);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().error.code, ErrorCode::no_data);
    EXPECT_EQ(kept(), 0U);
    rig::Rig first = rig_;
    ASSERT_TRUE(*use_fitted_robot(first, RobotFitting::if_needed));
    EXPECT_EQ(kept(), 1U);
    rig::Rig second = rig_;
    ASSERT_TRUE(*use_fitted_robot(second, RobotFitting::kept_only));
    EXPECT_EQ(first.urdf, second.urdf);
    EXPECT_FALSE(rig::padded_body(second)->empty());
    EXPECT_FALSE(*use_fitted_robot(second, RobotFitting::kept_only));  // it has no mesh
}

TEST_F(FittedRobot, is_made_anew_if_a_byte_of_the_mesh_or_of_the_urdf_changes) {
    rig::Rig rig = rig_;
    ASSERT_TRUE(use_fitted_robot(rig, RobotFitting::if_needed));
    std::string mesh = testing_support::wedge_stl();
    mesh[90] = static_cast<char>(mesh[90] ^ 1);
    folder_.write("arm.stl", mesh);
    rig = rig_;
    ASSERT_TRUE(use_fitted_robot(rig, RobotFitting::if_needed));
    EXPECT_EQ(kept(), 2U);
    folder_.write("arm.urdf", robot("0.21"));
    rig = rig_;
    ASSERT_TRUE(use_fitted_robot(rig, RobotFitting::if_needed));
    EXPECT_EQ(kept(), 3U);
}

TEST_F(FittedRobot, is_not_made_for_the_robot_of_a_recording) {
    rig_.urdf = FilePlace(NamedFolder(folder_.path()), "arm.urdf");
    EXPECT_FALSE(*use_fitted_robot(rig_, RobotFitting::if_needed));
    EXPECT_EQ(kept(), 0U);
}

TEST_F(FittedRobot, without_a_mesh_file_is_an_error_with_its_line) {
    fs::remove(folder_ / "arm.stl");
    const auto failed = use_fitted_robot(rig_, RobotFitting::if_needed);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().exit, ExitCode::bad_config);
    EXPECT_EQ(failed.error().error.code, ErrorCode::not_found);
    EXPECT_EQ(failed.error().error.line, 1);
}

TEST_F(FittedRobot, needs_a_folder_to_keep_it_in) {
    ::setenv("XDG_CACHE_HOME", "/proc/none", 1);
    const auto failed = use_fitted_robot(rig_, RobotFitting::if_needed);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().exit, ExitCode::cannot_create);
}

}  // namespace
}  // namespace octoskin
