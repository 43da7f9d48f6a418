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

namespace octoskin {
namespace {

using testing::HasSubstr;

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
    const char* words;
    int line;
    friend std::ostream& operator<<(std::ostream& out, const BrokenUrdf& broken) {
        return out << broken.file;
    }
};
class UrdfRobotRefuses : public testing::TestWithParam<BrokenUrdf> {};

TEST_P(UrdfRobotRefuses, naming_file_and_element) {
    const auto& [file, element, words, line] = GetParam();
    const std::vector<std::string> moved = {"elbow"};
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const auto model = read_robot_model(kBroken / file, "base", moved);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    ASSERT_FALSE(model);
    const std::string message = model.error().message();
    EXPECT_THAT(message, HasSubstr(file));
    EXPECT_THAT(message, HasSubstr(element));
    EXPECT_THAT(message, HasSubstr(words));
    EXPECT_EQ(model.error().line, line) << message;
}

INSTANTIATE_TEST_SUITE_P(
    Files, UrdfRobotRefuses,
    testing::Values(
        BrokenUrdf{"missing-child-link.urdf", "hand", "not a usable URDF", 0},
        BrokenUrdf{"loop-through-root.urdf", "link base", "found a loop", 2},
        BrokenUrdf{"loop-below-root.urdf", "link arm", "elbow and wrist_back", 3},
        BrokenUrdf{"loop-apart-from-root.urdf", "link arm", "found a loop", 3},
        BrokenUrdf{"two-parents.urdf", "link arm", "elbow and second", 3},
        BrokenUrdf{"non-unit-axis.urdf", "joint elbow",
                   "axis of length 1, found <axis xyz=\"0 0 2\"> of length 2: scale it to \"0 0 1\"", 4},
        BrokenUrdf{"zero-axis.urdf", "joint elbow", "axis of length 1, found <axis xyz=\"0 0 0\">", 4},
        BrokenUrdf{"limit-without-upper.urdf", "joint elbow",
                   "found no upper, which URDF treats as 0: write it", 4},
        BrokenUrdf{"unmoved-joint.urdf", "joint wrist", "gets no position", 11},
        BrokenUrdf{"no-such-joint.urdf", "joint elbow", "expected a moving joint", 0},
        BrokenUrdf{"base-missing.urdf", "link base", "expected this base link", 0},
        BrokenUrdf{"floating-joint.urdf", "joint elbow", "found another kind: make it type=\"fixed\"", 4},
        BrokenUrdf{"mimic-joint.urdf", "joint elbow", "found a mimic joint: make it type=\"fixed\"", 4},
        BrokenUrdf{"limits-reversed.urdf", "joint elbow", "limits the wrong way round", 4},
        BrokenUrdf{"nan-origin.urdf", "", "not a usable URDF", 0},
        BrokenUrdf{"nested-too-deep.urdf", "", "DEPTH", 1}, BrokenUrdf{"cut-off.urdf", "", "not XML", 5},
        BrokenUrdf{"not-xml.urdf", "", "expected a URDF with a <robot>, found none", 0},
        BrokenUrdf{"not-a-robot.urdf", "", "expected a URDF with a <robot>", 0},
        BrokenUrdf{"empty.urdf", "", "expected a URDF with a <robot>, found none", 0},
        BrokenUrdf{"absent.urdf", "", "cannot be opened", 0}));

// In the order of the file, whatever the order of the tree is.
TEST(UrdfRobot, every_joint_that_cannot_be_taken_is_in_one_message) {
    const std::vector<std::string> moved = {"elbow"};
    const auto model = read_robot_model(kBroken / "joints-of-every-refused-kind.urdf", "base", moved);
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().key, "joint finger");
    EXPECT_EQ(model.error().line, 8);
    EXPECT_THAT(model.error().what,
                HasSubstr("4 more refused: joint elbow (line 13, its axis), joint cart (line 17, planar), "
                          "joint drone (line 20, floating), joint lift (line 23, no upper limit)"));
}

}  // namespace
}  // namespace octoskin
