#include "host/apps/robot/fitted_robot.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "host/apps/recording/given_rig.hpp"
#include "host/io/robot/fit_store.hpp"
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
        folder_.write("upper.stl", testing_support::wedge_stl());
        folder_.write("arm.urdf", arm("upper.stl", 0.2));
        folder_.write("rig.yaml",
                      fmt::format("extends: {}/hw/rigs/bench_one_board.yaml\n"
                                  "name: fitted\n"
                                  "robot: {{urdf: arm.urdf, base_link: base, links_ignored_by_sensors: []}}\n"
                                  "joints: {{names: [j1]}}\n"
                                  "sensor_defaults: {{link: upper}}\n",
                                  OCTOSKIN_SOURCE_DIR));
    }
    ~FittedRobot() override { ::unsetenv("XDG_CACHE_HOME"); }

    static std::string arm(const std::string& mesh, double scale) {
        return fmt::format(
            "<robot name=\"r\"><link name=\"base\"/><link name=\"upper\"><collision><geometry><mesh "
            "filename=\"{}\" scale=\"{} 0.1 0.1\"/></geometry></collision></link><joint name=\"j1\" "
            "type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/><axis xyz=\"0 0 1\"/><limit "
            "lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>",
            mesh, scale);
    }
    [[nodiscard]] Result<rig::Rig, AppError> read(BodyFitting fitting, const GivenRobot& robot = {}) const {
        return read_rig_with_body(folder_ / "rig.yaml", robot, fitting);
    }
    [[nodiscard]] std::size_t kept() const {
        std::error_code none;
        std::size_t count = 0;
        for (fs::directory_iterator at(FitStore::of_this_user().folder(), none);
             at != fs::directory_iterator(); ++at)
            ++count;
        return count;
    }

    testing_support::ScratchFolder folder_;
};

TEST_F(FittedRobot, is_made_once_and_then_used_also_by_a_daemon) {
    const auto refused = read(BodyFitting::kept_only);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::bad_config);
    EXPECT_EQ(refused.error().error.code, ErrorCode::no_data);
    EXPECT_NE(refused.error().message().find("octoskin robot " + (folder_ / "arm.urdf").string() +
                                             " --base base --out"),
              std::string::npos);
    EXPECT_EQ(kept(), 0U);
    const auto first = read(BodyFitting::if_needed);
    ASSERT_TRUE(first) << first.error().message();
    EXPECT_EQ(kept(), 1U);
    const auto second = read(BodyFitting::kept_only);
    ASSERT_TRUE(second) << second.error().message();
    EXPECT_EQ(*robot_text(*first), *robot_text(*second));
    EXPECT_FALSE(rig::padded_body(*second)->empty());
    EXPECT_EQ(second->urdf.shown(), folder_ / "arm.urdf");
}

TEST_F(FittedRobot, needs_no_mesh_for_commands_that_use_no_body) {
    fs::remove(folder_ / "upper.stl");
    EXPECT_TRUE(read_given_rig(folder_ / "rig.yaml"));
    const auto failed = read(BodyFitting::if_needed);
    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().exit, ExitCode::bad_config);
    EXPECT_EQ(failed.error().error.code, ErrorCode::not_found);
    EXPECT_EQ(failed.error().error.line, 1);
}

TEST_F(FittedRobot, is_made_anew_if_a_byte_of_the_mesh_or_of_the_urdf_changes) {
    ASSERT_TRUE(read(BodyFitting::if_needed));
    std::string mesh = testing_support::wedge_stl();
    mesh[90] = static_cast<char>(mesh[90] ^ 1);
    folder_.write("upper.stl", mesh);
    EXPECT_FALSE(read(BodyFitting::kept_only));
    ASSERT_TRUE(read(BodyFitting::if_needed));
    EXPECT_EQ(kept(), 2U);
    folder_.write("arm.urdf", arm("upper.stl", 0.21));
    EXPECT_FALSE(read(BodyFitting::kept_only));
    ASSERT_TRUE(read(BodyFitting::if_needed));
    EXPECT_EQ(kept(), 3U);
}

TEST_F(FittedRobot, is_made_anew_in_place_of_a_fit_that_is_not_private_or_damaged) {
    const auto first = read(BodyFitting::if_needed);
    ASSERT_TRUE(first);
    const fs::path file = fs::directory_iterator(FitStore::of_this_user().folder())->path();
    const std::string whole = folder_.read(file);
    std::ofstream(file) << "<robot name=\"of somebody else\"/>";
    EXPECT_FALSE(read(BodyFitting::kept_only));
    EXPECT_EQ(*robot_text(*read(BodyFitting::if_needed)), *robot_text(*first));
    EXPECT_EQ(folder_.read(file), whole);
}

TEST_F(FittedRobot, is_found_in_the_package_that_the_user_places) {
    fs::create_directory(folder_ / "elsewhere");
    fs::rename(folder_ / "upper.stl", folder_ / "elsewhere/upper.stl");
    const GivenRobot robot{folder_.write("other.urdf", arm("package://arm/upper.stl", 0.2)),
                           {{"arm", folder_ / "elsewhere"}}};
    EXPECT_EQ(read(BodyFitting::if_needed, {robot.urdf, {}}).error().error.code, ErrorCode::not_found);
    const auto rig = read(BodyFitting::if_needed, robot);
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_FALSE(rig::padded_body(*rig)->empty());
}

TEST_F(FittedRobot, is_used_without_a_place_to_keep_it) {
    ::setenv("XDG_CACHE_HOME", "/proc/none", 1);
    const auto rig = read(BodyFitting::if_needed);
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_FALSE(rig::padded_body(*rig)->empty());
}

TEST_F(FittedRobot, is_not_made_for_the_robot_of_a_recording) {
    const auto own = read(BodyFitting::if_needed);
    ASSERT_TRUE(own) << own.error().message();
    ASSERT_EQ(kept(), 1U);
    fs::remove_all(FitStore::of_this_user().folder());
    folder_.write("can.log", "");
    folder_.write("rig.yaml", rig::canonical_text(*own, "arm.urdf"));
    const auto rig = read(BodyFitting::if_needed);
    ASSERT_TRUE(rig) << rig.error().message();
    EXPECT_EQ(kept(), 0U);
    EXPECT_EQ(*robot_text(*rig), arm("upper.stl", 0.2));
    EXPECT_FALSE(rig::padded_body(*rig));
}

TEST_F(FittedRobot, does_not_wait_for_a_pipe_in_place_of_a_mesh) {
    fs::remove(folder_ / "upper.stl");
    ASSERT_EQ(::mkfifo((folder_ / "upper.stl").c_str(), 0600), 0);
    EXPECT_EQ(read(BodyFitting::if_needed).error().error.code, ErrorCode::wrong_kind_of_file);
}

}  // namespace
}  // namespace octoskin
