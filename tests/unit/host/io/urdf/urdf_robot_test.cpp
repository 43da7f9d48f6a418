// The Panda's URDF through KDL. Oracle: the product of modified Denavit-Hartenberg transforms, written out
// here.
#include "host/io/urdf/urdf_robot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <ostream>
#include <random>
#include <vector>

#include "tests/support/errors/error_fields.hpp"
#include "tests/support/scratch_folder.hpp"

namespace octoskin {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing_support::code_is;
using testing_support::file_is;
using testing_support::has_its_fields;
using testing_support::key_is;
using testing_support::line_is;
using testing_support::others_are;
using testing_support::remedy_is;
using testing_support::value_is;
using testing_support::what_is;

const std::filesystem::path kPanda = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "hw/robots/panda.urdf";
const std::filesystem::path kBroken = std::filesystem::path(OCTOSKIN_SOURCE_DIR) / "tests/data/rigs";
const std::vector<std::string> kJoints = {"panda_joint1", "panda_joint2", "panda_joint3", "panda_joint4",
                                          "panda_joint5", "panda_joint6", "panda_joint7"};

/// Row i: a and alpha of link i - 1, d of joint i.
struct DhRow {
    double a_m;
    double d_m;
    double alpha_deg;
};
constexpr std::array<DhRow, 7> kPandaDh = {
    DhRow{0.0, 0.333, 0.0},       DhRow{0.0, 0.0, -90.0}, DhRow{0.0, 0.316, 90.0}, DhRow{0.0825, 0.0, 90.0},
    DhRow{-0.0825, 0.384, -90.0}, DhRow{0.0, 0.0, 90.0},  DhRow{0.088, 0.0, 90.0}};
constexpr double kFlangeM = 0.107;

/// Craig's modified convention: rotate about x by alpha, along x by a, about z by theta, along z by d;
/// written out.
Eigen::Matrix4d dh(const DhRow& row, double theta) {
    const double alpha = row.alpha_deg * std::numbers::pi / 180.0;
    const double ca = std::cos(alpha), sa = std::sin(alpha), ct = std::cos(theta), st = std::sin(theta);
    Eigen::Matrix4d T;
    T << ct, -st, 0, row.a_m,                  //
        st * ca, ct * ca, -sa, -sa * row.d_m,  //
        st * sa, ct * sa, ca, ca * row.d_m,    //
        0, 0, 0, 1;
    return T;
}

TEST(UrdfRobot, panda_links_equal_the_denavit_hartenberg_product_over_10000_poses) {
    const auto model = read_robot_model(kPanda, "panda_link0", kJoints);
    ASSERT_TRUE(model) << model.error().message();
    std::mt19937 engine(7);
    std::vector<Eigen::Isometry3d> T_base_link(model->link_count());
    double worst = 0.0;
    for (int draw = 0; draw < 10'000; ++draw) {
        std::array<double, 7> q{};
        for (std::size_t i = 0; i < 7; ++i) {
            q[i] = std::uniform_real_distribution<>(model->limits()[i].min, model->limits()[i].max)(engine);
        }
        model->forward(q, T_base_link);
        Eigen::Matrix4d expected = Eigen::Matrix4d::Identity();
        for (std::size_t i = 0; i < 7; ++i) {
            expected = expected * dh(kPandaDh[i], q[i]);
            const LinkId link = model->find_link("panda_link" + std::to_string(i + 1)).value();
            worst = std::max(worst, (T_base_link[link].matrix() - expected).cwiseAbs().maxCoeff());
        }
        expected = expected * dh({0.0, kFlangeM, 0.0}, 0.0);
        const LinkId flange = model->find_link("panda_link8").value();
        worst = std::max(worst, (T_base_link[flange].matrix() - expected).cwiseAbs().maxCoeff());
    }
    EXPECT_LE(worst, 1e-12);
}

TEST(UrdfRobot, panda_has_nine_links_with_the_base_first_and_its_limits_in_the_order_asked_for) {
    const std::vector<std::string> reversed(kJoints.rbegin(), kJoints.rend());
    const auto model = read_robot_model(kPanda, "panda_link0", reversed);
    ASSERT_TRUE(model);
    EXPECT_EQ(model->link_count(), 9U);
    EXPECT_EQ(model->link_names()[0], "panda_link0");
    ASSERT_EQ(model->limits().size(), 7U);
    EXPECT_EQ(model->limits()[3].min, -3.0718);
    EXPECT_EQ(model->limits()[3].max, -0.0698);
    EXPECT_EQ(model->limits()[1].min, -0.0175);
    EXPECT_EQ(model->limits()[1].max, 3.7525);
}

TEST(UrdfRobot, base_link_may_be_inside_the_tree) {
    const std::vector<std::string> wrist(kJoints.begin() + 4, kJoints.end());
    const auto model = read_robot_model(kPanda, "panda_link4", wrist);
    ASSERT_TRUE(model) << model.error().message();
    EXPECT_EQ(model->link_count(), 5U);
    EXPECT_FALSE(model->find_link("panda_link0"));
}

TEST(UrdfRobot, every_kind_of_joint_arrives_as_what_it_is) {
    const std::vector<std::string> moved = {"axle", "rail", "elbow"};
    const auto model = read_robot_model(kBroken / "every-kind-of-joint.urdf", "base", moved);
    ASSERT_TRUE(model) << model.error().message();
    EXPECT_EQ(model->limits()[0].max, std::numeric_limits<double>::infinity());
    EXPECT_EQ(model->limits()[1].min, -2.0);
    std::vector<Eigen::Isometry3d> T_base_link(model->link_count());
    model->forward(std::array{std::numbers::pi / 2.0, 1.5, std::numbers::pi / 2.0}, T_base_link);
    const auto& T_base_wheel = T_base_link[model->find_link("wheel").value()];
    EXPECT_TRUE(T_base_wheel.translation().isApprox(Eigen::Vector3d(1.5, 0, 0)));
    EXPECT_TRUE(T_base_wheel.linear().col(0).isApprox(-Eigen::Vector3d::UnitZ()));
    const auto& T_base_plate = T_base_link[model->find_link("plate").value()];
    EXPECT_TRUE(T_base_plate.translation().isApprox(Eigen::Vector3d(1.5, 0, 0.5)));
    EXPECT_TRUE(T_base_plate.linear().col(0).isApprox(Eigen::Vector3d::UnitY()));
}

struct BrokenUrdf {
    const char* file;
    const char* element;
    int line;
    ErrorCode code;
    const char* value = "";
    const char* also = "";  ///< part of the rule or of the remedy
    friend std::ostream& operator<<(std::ostream& out, const BrokenUrdf& broken) {
        return out << broken.file;
    }
};
class UrdfRobotRefuses : public testing::TestWithParam<BrokenUrdf> {};

TEST_P(UrdfRobotRefuses, naming_file_and_element) {
    const auto& [file, element, line, code, value, also] = GetParam();
    const std::vector<std::string> moved = {"elbow"};
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const auto model = read_robot_model(kBroken / file, "base", moved);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_FALSE(model);
    const Error& error = model.error();
    EXPECT_THAT(error, AllOf(file_is(file), key_is(element), line_is(line), code_is(code), value_is(value)));
    EXPECT_THAT(error, AnyOf(what_is(HasSubstr(also)), remedy_is(HasSubstr(also))));
    EXPECT_TRUE(has_its_fields(error));
}

INSTANTIATE_TEST_SUITE_P(
    Files, UrdfRobotRefuses,
    testing::Values(
        BrokenUrdf{"missing-child-link.urdf", "", 0, ErrorCode::bad_value, "", "hand"},
        BrokenUrdf{"loop-through-root.urdf", "link base", 2, ErrorCode::bad_value, "a loop"},
        BrokenUrdf{"loop-below-root.urdf", "link arm", 3, ErrorCode::duplicate, "elbow and wrist_back"},
        BrokenUrdf{"loop-apart-from-root.urdf", "link arm", 3, ErrorCode::bad_value, "a loop"},
        BrokenUrdf{"two-parents.urdf", "link arm", 3, ErrorCode::duplicate, "elbow and second"},
        BrokenUrdf{"non-unit-axis.urdf", "joint elbow", 4, ErrorCode::bad_value,
                   "<axis xyz=\"0 0 2\"> of length 2", "\"0 0 1\""},
        BrokenUrdf{"zero-axis.urdf", "joint elbow", 4, ErrorCode::bad_value, "<axis xyz=\"0 0 0\">",
                   "axis of length 1"},
        BrokenUrdf{"limit-without-upper.urdf", "joint elbow", 4, ErrorCode::missing_key,
                   "no upper, which URDF treats as 0", "write it"},
        BrokenUrdf{"unmoved-joint.urdf", "joint wrist", 11, ErrorCode::bad_value, "", "gets no position"},
        BrokenUrdf{"no-such-joint.urdf", "joint elbow", 0, ErrorCode::bad_value, "",
                   "expected a moving joint"},
        BrokenUrdf{"base-missing.urdf", "link base", 0, ErrorCode::unknown_name, "",
                   "expected this base link"},
        BrokenUrdf{"floating-joint.urdf", "joint elbow", 4, ErrorCode::unsupported, "another kind",
                   "type=\"fixed\""},
        BrokenUrdf{"mimic-joint.urdf", "joint elbow", 4, ErrorCode::bad_value, "",
                   "a joint that moves by itself"},
        BrokenUrdf{"limits-reversed.urdf", "joint elbow", 4, ErrorCode::bad_value, "",
                   "limits the wrong way round"},
        BrokenUrdf{"nan-origin.urdf", "", 0, ErrorCode::bad_value, "", "not a usable URDF"},
        BrokenUrdf{"nested-too-deep.urdf", "", 1, ErrorCode::bad_syntax, "", "DEPTH"},
        BrokenUrdf{"cut-off.urdf", "", 5, ErrorCode::bad_syntax, "", "not XML"},
        BrokenUrdf{"not-xml.urdf", "", 0, ErrorCode::foreign_format, "", "a URDF with a <robot>"},
        BrokenUrdf{"not-a-robot.urdf", "", 0, ErrorCode::foreign_format, "", "a URDF with a <robot>"},
        BrokenUrdf{"empty.urdf", "", 0, ErrorCode::foreign_format, "", "a URDF with a <robot>"},
        BrokenUrdf{"absent.urdf", "", 0, ErrorCode::not_found}));

/// A base link with these two joints above it, a metre along x and a quarter turn each.
Result<RobotFrames, Error> frames_below(const std::string& upper, const std::string& lower,
                                        const std::string& base_link = "base") {
    const testing_support::ScratchFolder folder;
    const auto joint = [](const char* name, const std::string& type, const char* parent, const char* child) {
        return std::string("<joint name='") + name + "' type='" + type + "'><parent link='" + parent +
               "'/><child link='" + child +
               "'/><axis xyz='0 0 1'/><origin xyz='1 0 0' rpy='0 0 1.5707963267948966'/></joint>";
    };
    const auto file =
        folder.write("robot.urdf",
                     "<robot name='r'><link name='world'/><link name='cart'/><link name='base'/>"
                     "<link name='arm'/>" +
                         joint("rails", upper, "world", "cart") + joint("mount", lower, "cart", "base") +
                         joint("wrist", "continuous", "base", "arm") + "</robot>");
    return read_robot_frames(file, base_link);
}

TEST(RobotFrames, begin_at_the_root_above_the_fixed_joints) {
    const auto frames = frames_below("fixed", "fixed");
    ASSERT_TRUE(frames) << frames.error().message();
    EXPECT_EQ(frames->root_link, "world");
    EXPECT_EQ(frames->base_link, "base");
    EXPECT_EQ(frames->links, (std::vector<std::string>{"arm", "base", "cart", "world"}));
    Eigen::Matrix4d expected;  // half a turn, a metre along x and one along y
    expected << -1, 0, 0, 1, 0, -1, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1;
    EXPECT_TRUE(frames->T_root_base.matrix().isApprox(expected, 1e-12)) << frames->T_root_base.matrix();
}

TEST(RobotFrames, end_below_a_joint_without_a_position) {
    for (const char* kind : {"floating", "planar"}) {
        const auto cart = frames_below(kind, "fixed");
        ASSERT_TRUE(cart) << cart.error().message();
        EXPECT_EQ(cart->root_link, "cart") << kind;
        EXPECT_NEAR(cart->T_root_base.translation().x(), 1.0, 1e-12);
        EXPECT_NEAR(cart->T_root_base.translation().y(), 0.0, 1e-12);
        const auto alone = frames_below("fixed", kind);
        ASSERT_TRUE(alone) << alone.error().message();
        EXPECT_EQ(alone->root_link, "base") << kind;
        EXPECT_TRUE(alone->T_root_base.matrix().isIdentity());
        EXPECT_EQ(alone->links.size(), 4U);
    }
}

TEST(RobotFrames, of_an_unknown_base_link_are_refused) {
    const auto frames = frames_below("fixed", "fixed", "waist");
    ASSERT_FALSE(frames);
    EXPECT_THAT(frames.error(), AllOf(code_is(ErrorCode::unknown_name), key_is("link waist")));
}

// In the order of the file, whatever the order of the tree is.
TEST(UrdfRobot, every_joint_that_cannot_be_taken_is_in_one_message) {
    const std::vector<std::string> moved = {"elbow"};
    const auto model = read_robot_model(kBroken / "joints-of-every-refused-kind.urdf", "base", moved);
    ASSERT_FALSE(model);
    EXPECT_THAT(model.error(),
                AllOf(key_is("joint elbow"), line_is(13),
                      others_are("3 more refused: joint cart (line 17, planar), joint drone (line 20, "
                                 "floating), joint lift (line 23, no upper limit)")));
}

}  // namespace
}  // namespace octoskin
