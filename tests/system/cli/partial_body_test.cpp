// An arm that has a body on some links only: never silence, and never "free".
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "host/io/mapfile/map_file.hpp"
#include "tests/system/cli/failure.hpp"
#include "tests/system/cli/program.hpp"

namespace octoskin {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::code_is;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::remedy_is;
using testing_support::value_is;
using Json = nlohmann::json;

class PartialBodyTest : public ProgramTest {
  protected:
    /// Free within 2.56 m of the origin; with a post of 12 cm where the upper arm of the posture 0, 0 is.
    [[nodiscard]] std::string map(bool has_post) const {
        FusedMap map{MapConfig{.resolution_m = 0.04}};
        constexpr std::array<std::uint16_t, 2> kSides{32704, 32768};
        for (const auto x : kSides)
            for (const auto y : kSides)
                for (const auto z : kSides) EXPECT_TRUE(map.set_cube({{x, y, z}, 6}, -1.0F));
        for (int x = 0; has_post && x < 3; ++x) {
            for (int y = 0; y < 3; ++y) {
                for (int z = 0; z < 12; ++z) {
                    const Eigen::Vector3d at(0.26 + 0.04 * x, -0.04 + 0.04 * y, 0.02 + 0.04 * z);
                    EXPECT_TRUE(map.set_cube({*map.key_of(at), 0}, 2.0F));
                }
            }
        }
        const auto saved = save_map(map, path("map.ot"));
        EXPECT_TRUE(saved) << saved.error().message();
        return path("map.ot");
    }
    static std::string rig(const std::string& file) { return source("tests/data/partial_body/" + file); }
    static Said query(const std::string& map, const std::string& more) {
        return run(OCTOSKIN_PROGRAM " query " + map + " --joints 0,0 " + more, "2>/dev/null");
    }
};

TEST_F(PartialBodyTest, a_post_through_a_link_without_a_body_is_not_free) {
    const Said said = query(map(true), "--json --rig " + rig("rig.yaml"));
    EXPECT_EQ(said.exit_code, 2) << said.output;
    const Json answer = Json::parse(said.output);
    EXPECT_EQ(answer["state"], "unknown");
    EXPECT_EQ(answer["legs"][0]["link"], "upper");
    EXPECT_EQ(answer["links"], Json({"tool"}));
    EXPECT_EQ(answer["links_without_body"], Json({"upper"}));
    EXPECT_EQ(answer["links_unknown"], Json({"upper"}));
    const Said text = query(path("map.ot"), "--rig " + rig("rig.yaml"));
    EXPECT_EQ(text.exit_code, 2);
    EXPECT_THAT(text.output, testing::StartsWith("unknown: upper has no body\n"));
    EXPECT_THAT(text.output, Not(HasSubstr("--own-space"))) << "that would not help";
}

TEST_F(PartialBodyTest, a_speck_on_a_bolt_is_no_body_of_the_link_that_it_is_fixed_to) {
    const std::string speck = "--rig " + rig("rig.yaml") + " --robot " + rig("speck.urdf");
    const Said said = query(map(true), "--json " + speck);
    EXPECT_EQ(said.exit_code, 2) << said.output;
    const Json answer = Json::parse(said.output);
    EXPECT_EQ(answer["state"], "unknown");
    EXPECT_EQ(answer["links"], Json({"bolt", "tool"}));
    EXPECT_EQ(answer["links_without_body"], Json({"upper"}));
    EXPECT_EQ(answer["links_unknown"], Json({"upper"}));
    EXPECT_EQ(answer["links_with_borrowed_body"], Json({{"fore", "tool"}}));
    EXPECT_THAT(query(path("map.ot"), speck).output,
                HasSubstr("checked with the body of tool, to which it is fixed: fore\n"));
    const Said checked = octoskin("rig " + rig("rig.yaml") + " --robot " + rig("speck.urdf"));
    EXPECT_THAT(checked.output, HasSubstr("  link upper: no body: a query"));
    EXPECT_THAT(checked.output, HasSubstr("  link fore: no body of its own: it uses that of tool,"));
}

TEST_F(PartialBodyTest, a_post_through_the_same_link_with_a_body_is_occupied) {
    const std::string whole = "--json --rig " + rig("rig.yaml") + " --robot " + rig("arm_whole.urdf");
    const Said said = query(map(true), whole);
    EXPECT_EQ(said.exit_code, 1) << said.output;
    EXPECT_EQ(Json::parse(said.output)["legs"][0]["link"], "upper");
    EXPECT_EQ(Json::parse(said.output)["links"], Json({"upper", "tool"}));
    EXPECT_EQ(Json::parse(said.output)["links_without_body"], Json::array());
    EXPECT_EQ(query(map(false), whole).exit_code, 0);
}

TEST_F(PartialBodyTest, a_rig_that_lists_the_link_has_it_left_out) {
    const Said said = query(map(false), "--json --rig " + rig("listed.yaml"));
    EXPECT_EQ(said.exit_code, 0) << said.output;
    EXPECT_EQ(Json::parse(said.output)["links_without_body"], Json({"upper"}));
    EXPECT_EQ(Json::parse(said.output)["links_unknown"], Json::array());
    EXPECT_THAT(failure_of("query " + path("map.ot") + " --joints 0,0 --rig " + rig("listed.yaml") +
                           " --robot " + rig("arm_whole.urdf")),
                fails_with(78, code_is(ErrorCode::conflict), path_is(rig("listed.yaml")), line_is(4),
                           key_is("robot.links_without_body"), value_is(HasSubstr("'upper'")),
                           remedy_is(HasSubstr("remove it"))));
}

TEST_F(PartialBodyTest, rig_names_the_link) {
    const Said unlisted = octoskin("rig " + rig("rig.yaml"));
    EXPECT_EQ(unlisted.exit_code, 0);
    EXPECT_THAT(unlisted.output, HasSubstr("upper: this link moves"));
    EXPECT_THAT(unlisted.output, HasSubstr("  link upper: no body: a query"));
    const Said listed = octoskin("rig " + rig("listed.yaml"));
    EXPECT_THAT(listed.output, Not(HasSubstr("this link moves")));
    EXPECT_THAT(listed.output, HasSubstr("  link upper: no body, as the rig lists\n"));
    const Said canonical = octoskin("rig --canonical " + rig("listed.yaml"));
    EXPECT_THAT(canonical.output, HasSubstr("  links_without_body:\n    - \"upper\"\n"));
}

/// The robot and the rig are in the recording: so is which link has no body.
TEST_F(PartialBodyTest, replay_says_of_a_recording_what_was_said_of_its_rig) {
    std::string urdf = content(source("hw/robots/panda.urdf"));
    const std::string frame = "<link name=\"panda_link5\"/>";
    ASSERT_NE(urdf.find(frame), std::string::npos);
    urdf.replace(
        urdf.find(frame), frame.size(),
        "<link name=\"panda_link5\"><visual><geometry><mesh filename=\"5.dae\"/></geometry></visual></link>");
    write(path("panda.urdf"), urdf);
    const std::string extends =
        "extends: " + source("tests/data/short/rig.yaml") + "\nrobot: {urdf: panda.urdf";
    write(path("unlisted.yaml"), extends + "}\n");
    write(path("listed.yaml"), extends + ", links_without_body: [panda_link5]}\n");
    const auto replayed = [this](const std::string& name) {
        const Said simulated = octoskin("simulate " + path(name) + " --rig " + path(name + ".yaml") +
                                        " --scenario " + source("tests/data/short/scenario.yaml"));
        EXPECT_EQ(simulated.exit_code, 0) << simulated.output;
        return octoskin("replay " + path(name) + " --fused-only");
    };
    const Said unlisted = replayed("unlisted");
    EXPECT_EQ(unlisted.exit_code, 0) << unlisted.output;
    EXPECT_THAT(unlisted.output, HasSubstr("panda_link5: this link moves"));
    const Said listed = replayed("listed");
    EXPECT_EQ(listed.exit_code, 0) << listed.output;
    EXPECT_THAT(listed.output, Not(HasSubstr("panda_link5")));
}

TEST_F(PartialBodyTest, replay_tells_whose_body_stands_for_a_link) {
    std::string urdf = content(source("hw/robots/panda.urdf"));
    const std::string end = "</robot>";
    urdf.replace(urdf.find(end), end.size(),
                 "<link name=\"mount\"><visual><geometry><box size=\"0.05 0.05 0.05\"/></geometry></visual>"
                 "</link><joint name=\"mounts\" type=\"fixed\"><parent link=\"panda_link2\"/><child "
                 "link=\"mount\"/></joint></robot>");
    write(path("panda.urdf"), urdf);
    write(path("mount.yaml"),
          "extends: " + source("tests/data/short/rig.yaml") + "\nrobot: {urdf: panda.urdf}\n");
    const Said simulated = octoskin("simulate " + path("mount") + " --rig " + path("mount.yaml") +
                                    " --scenario " + source("tests/data/short/scenario.yaml"));
    ASSERT_EQ(simulated.exit_code, 0) << simulated.output;
    const Said replayed = octoskin("replay " + path("mount") + " --fused-only");
    EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
    EXPECT_THAT(replayed.output, HasSubstr("mount: this link moves, has a <visual> and no body of its own; "
                                           "the body of panda_link2, "));
}

}  // namespace
}  // namespace octoskin
