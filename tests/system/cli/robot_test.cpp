// A robot with meshes: fitted once, then used by each command, also by the daemon.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"
#include "tests/unit/hw/mesh/shape_files.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::key_is;
using Json = nlohmann::json;

class RobotTest : public ProgramTest {
  protected:
    RobotTest() {
        std::filesystem::create_directory(directory_ / "arm");
        write(path("arm/upper.stl"), testing_support::wedge_stl());
        write(path("arm.urdf"), arm("package://arm_description/upper.stl"));
        write(path("rig.yaml"), "extends: " + source("hw/rigs/bench_one_board.yaml") +
                                    "\nname: arm\nrobot: {urdf: arm.urdf, base_link: base, "
                                    "links_ignored_by_sensors: []}\njoints: {names: [j1]}\nsensor_defaults: "
                                    "{link: upper}\n");
    }
    static std::string arm(const std::string& mesh) {
        return "<robot name=\"r\"><link name=\"base\"/><link name=\"upper\"><collision><geometry><mesh "
               "filename=\"" +
               mesh +
               "\" scale=\"0.3 0.3 0.3\"/></geometry></collision></link><joint name=\"j1\" "
               "type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/><limit lower=\"-1\" "
               "upper=\"1\" effort=\"1\" velocity=\"1\"/></joint></robot>";
    }
    [[nodiscard]] Said program(const std::string& arguments, const std::string& errors = "2>&1") const {
        return run("XDG_CACHE_HOME=" + path("cache") + " " OCTOSKIN_PROGRAM " " + arguments, errors);
    }
    [[nodiscard]] std::string given() const { return " --package-path arm_description=" + path("arm") + " "; }
};

TEST_F(RobotTest, its_fit_is_printed_written_and_drawn) {
    const Said said = program("robot " + path("arm.urdf") + given() + "--json --out " + path("fitted.urdf") +
                                  " --picture " + path("arm.svg"),
                              "2>/dev/null");
    ASSERT_EQ(said.exit_code, 0) << said.output;
    const Json robot = Json::parse(said.output);
    EXPECT_EQ(robot["base_link"], "base");
    EXPECT_EQ(robot["joints"][0]["name"], "j1");
    EXPECT_EQ(robot["links"][1]["body"], "collision");
    EXPECT_GT(robot["links"][1]["capsules"], 0);
    EXPECT_THAT(content(path("arm.svg")), HasSubstr("</svg>"));
    EXPECT_THAT(content(path("fitted.urdf")), Not(HasSubstr("<mesh")));
    std::filesystem::remove_all(directory_ / "arm");
    const Said rig = program("rig " + path("rig.yaml") + " --robot " + path("fitted.urdf"));
    EXPECT_EQ(rig.exit_code, 0) << rig.output;
}

TEST_F(RobotTest, without_its_meshes_it_is_refused_with_the_option_that_places_them) {
    for (const std::string& command : {"robot " + path("arm.urdf"), "rig " + path("rig.yaml")}) {
        const Said said = program(command);
        EXPECT_EQ(said.exit_code, 78) << said.output;
        EXPECT_THAT(said.output, HasSubstr("--package-path arm_description="));
    }
    for (const char* wrong : {"arm_description", "=", "=x", "arm="}) {
        const Said said = program("rig " + path("rig.yaml") + " --package-path " + std::string(wrong));
        EXPECT_EQ(said.exit_code, 64) << said.output;
    }
}

TEST_F(RobotTest, run_uses_the_fit_that_rig_kept) {
    write(path("maps"), "");  // a file in place of the folder ends a daemon whose robot was read
    const std::string daemon = "run --rig " + path("rig.yaml") + given() +
                               "--no-camera --can no-such-can0 --socket " + path("s") + " --maps " +
                               path("maps");
    const Said before = program(daemon);
    EXPECT_EQ(before.exit_code, 78) << before.output;
    EXPECT_THAT(before.output, HasSubstr("octoskin robot " + path("arm.urdf") + " --base base --out"));
    const Said rig = program("rig " + path("rig.yaml") + given());
    EXPECT_EQ(rig.exit_code, 0) << rig.output;
    EXPECT_THAT(rig.output, HasSubstr("fitting link upper"));
    const Said after = program(daemon);
    EXPECT_EQ(after.exit_code, 73) << after.output;
    const Said again = program("rig " + path("rig.yaml") + given());
    EXPECT_EQ(again.exit_code, 0) << again.output;
    EXPECT_THAT(again.output, Not(HasSubstr("fitting")));
}

TEST_F(RobotTest, a_command_that_uses_no_body_needs_no_mesh) {
    std::filesystem::remove_all(directory_ / "arm");
    const Said said = program("mapping denoised --rig " + path("rig.yaml"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
    const Said joints =
        program("joints --rig " + path("rig.yaml") + " --socket " + path("s") + " < /dev/null");
    EXPECT_EQ(joints.exit_code, 0) << joints.output;
}

TEST_F(RobotTest, a_link_with_a_mesh_may_be_listed_as_one_without_a_body) {
    write(path("listed.yaml"), "extends: rig.yaml\nrobot: {links_without_body: [upper]}\n");
    const Said said = program("rig " + path("listed.yaml") + given());
    EXPECT_EQ(said.exit_code, 0) << said.output;
}

TEST_F(RobotTest, a_package_that_the_user_places_wrongly_is_refused_although_another_has_the_file) {
    write(path("upper.stl"), testing_support::wedge_stl());
    for (const std::string& folder : {path("no_folder"), path("rig.yaml"), path("cache")}) {
        std::filesystem::create_directory(path("cache"));
        const Said said = program("rig " + path("rig.yaml") + " --package-path arm_description=" + folder);
        EXPECT_EQ(said.exit_code, 78) << said.output;
    }
}

TEST_F(RobotTest, its_names_and_files_are_in_the_json_whatever_their_bytes_are) {
    write(path("latin.urdf"),
          "<robot name=\"r\"><link name=\"\xe4\"><collision><geometry><mesh filename=\"arm/upper.stl\" "
          "scale=\".1 .1 .1\"/></geometry></collision></link></robot>");
    const Said said = program("robot " + path("latin.urdf") + " --json", "2>/dev/null");
    ASSERT_EQ(said.exit_code, 0) << said.output;
    const Json robot = Json::parse(said.output);
    EXPECT_EQ(robot["links"].size(), 1U);
    EXPECT_EQ(robot["links"][0]["files"], Json({path("arm/upper.stl")}));
}

TEST_F(RobotTest, its_files_are_not_replaced_by_what_is_made_of_them) {
    const std::string mesh = content(path("arm/upper.stl"));
    const std::string urdf = content(path("arm.urdf"));
    for (const std::string& out :
         {"--out " + path("arm.urdf"), "--out " + path("arm/upper.stl"), "--picture " + path("arm.urdf"),
          "--out " + path("x") + " --picture " + path("x")}) {
        const Said said = program("robot " + path("arm.urdf") + given() + out);
        EXPECT_EQ(said.exit_code, 64) << out << said.output;
    }
    EXPECT_EQ(content(path("arm/upper.stl")), mesh);
    EXPECT_EQ(content(path("arm.urdf")), urdf);
}

}  // namespace
}  // namespace octoskin
