// The kinematic model from plain descriptions. Oracle: the product of Eigen transforms, link by link.
#include "host/core/kinematics/robot_model.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <utility>

namespace octoskin {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const std::vector<std::string> kMoved = {"slide", "turn", "spin"};

Isometry3d placed(const Vector3d& axis, double angle, const Vector3d& position) {
    return Eigen::Translation3d(position) * Eigen::AngleAxisd(angle, axis.normalized());
}

/// A tree: base - turn - arm; arm - slide - hand; arm - spin - side; hand - glued - tool. Listed children
/// first.
std::vector<JointDescription> tree() {
    return {
        {"glued",
         "hand",
         "tool",
         JointKind::fixed,
         placed({1, 0, 0}, 0.3, {0, 0, 0.1}),
         Vector3d::Zero(),
         {}},
        {"slide",
         "arm",
         "hand",
         JointKind::prismatic,
         placed({0, 1, 0}, -0.7, {0.2, 0, 0}),
         {0, -1, 0},
         {-0.5, 0.5}},
        {"spin",
         "arm",
         "side",
         JointKind::continuous,
         placed({1, 1, 0}, 0.4, {0, 0.3, 0}),
         Vector3d(1, 2, -2) / 3.0,
         {}},
        {"turn",
         "base",
         "arm",
         JointKind::revolute,
         placed({0, 0, 1}, 1.1, {0, 0, 0.5}),
         {0, 0, -1},
         {-2, 1.5}},
    };
}

RobotModel built(const std::vector<JointDescription>& joints) {
    auto model = RobotModel::build("base", joints, kMoved);
    EXPECT_TRUE(model) << model.error().element;
    return std::move(model).value();
}

/// Of what lies between the first joint and a link, and of how far a prismatic one is out: nothing below.
TEST(RobotModel, tells_how_long_the_lever_of_a_link_is_at_most) {
    const RobotModel model = built(tree());
    const auto levers_m = model.levers_m(std::array{0.4, 2.0, 3.0});
    const auto of = [&](const char* link) { return levers_m.at(*model.find_link(link)); };
    EXPECT_EQ(of("base"), 0.0);
    EXPECT_EQ(of("arm"), 0.0);
    EXPECT_NEAR(of("hand"), 0.2 + 0.4, 1e-12);
    EXPECT_NEAR(of("tool"), 0.2 + 0.4 + 0.1, 1e-12);
    EXPECT_NEAR(of("side"), 0.3, 1e-12);
}

TEST(RobotModel, every_kind_of_joint_and_axis_equals_the_product_of_transforms) {
    const RobotModel model = built(tree());
    const auto joints = tree();
    std::mt19937 engine(3);
    std::uniform_real_distribution<> uniform(-1.5, 1.5);
    std::vector<Isometry3d> T_base_link(model.link_count());
    for (int draw = 0; draw < 1000; ++draw) {
        const std::array<double, 3> q = {uniform(engine) / 3.0, uniform(engine), 4.0 * uniform(engine)};
        model.forward(q, T_base_link);
        const Isometry3d T_base_arm = joints[3].T_parent_joint * Eigen::AngleAxisd(q[1], joints[3].axis);
        const Isometry3d T_base_hand =
            T_base_arm * joints[1].T_parent_joint * Eigen::Translation3d(q[0] * joints[1].axis);
        const Isometry3d T_base_side =
            T_base_arm * joints[2].T_parent_joint * Eigen::AngleAxisd(q[2], joints[2].axis);
        const Isometry3d T_base_tool = T_base_hand * joints[0].T_parent_joint;
        const auto error = [&](const char* link, const Isometry3d& expected) {
            return (T_base_link[model.find_link(link).value()].matrix() - expected.matrix())
                .cwiseAbs()
                .maxCoeff();
        };
        ASSERT_LE(error("base", Isometry3d::Identity()), 0.0);
        ASSERT_LE(error("arm", T_base_arm), 1e-14);
        ASSERT_LE(error("hand", T_base_hand), 1e-14);
        ASSERT_LE(error("side", T_base_side), 1e-14);
        ASSERT_LE(error("tool", T_base_tool), 1e-14);
    }
}

/// The tree with a leaf on `side` that turns with `spin`, and a jaw on `hand` that slides with `slide`.
std::vector<JointDescription> tree_with_mimics() {
    auto joints = tree();
    JointDescription follow{"follow",
                            "side",
                            "leaf",
                            JointKind::continuous,
                            placed({0, 1, 0}, 0.2, {0.1, 0, 0}),
                            Vector3d(2, 1, -2) / 3.0,
                            {}};
    follow.mimic = {"spin", -2.0, 0.2};
    JointDescription jaw{
        "jaw",     "hand", "jaw", JointKind::prismatic, placed({1, 0, 1}, -0.3, {0, 0, 0.05}),
        {0, 0, 1}, {-2, 2}};
    jaw.mimic = {"slide", 2.0, -0.1};
    joints.insert(joints.begin(), {follow, jaw});
    return joints;
}

TEST(RobotModel, a_joint_that_mimics_another_moves_with_it) {
    const auto joints = tree_with_mimics();
    const RobotModel model = built(joints);
    ASSERT_EQ(model.joint_count(), 3U);
    EXPECT_EQ(model.limits()[0].max, 0.5);  // of `slide` itself
    std::mt19937 engine(4);
    std::uniform_real_distribution<> uniform(-1.5, 1.5);
    std::vector<Isometry3d> T_base_link(model.link_count());
    for (int draw = 0; draw < 100; ++draw) {
        const double slide = uniform(engine) / 3.0;
        const double spin = 4.0 * uniform(engine);
        model.forward(std::array{slide, uniform(engine), spin}, T_base_link);
        const auto of = [&](const char* link) { return T_base_link[model.find_link(link).value()]; };
        const Isometry3d leaf =
            of("side") * joints[0].T_parent_joint * Eigen::AngleAxisd(-2.0 * spin + 0.2, joints[0].axis);
        const Isometry3d jaw = of("hand") * joints[1].T_parent_joint *
                               Eigen::Translation3d((2.0 * slide - 0.1) * joints[1].axis);
        EXPECT_LE((of("leaf").matrix() - leaf.matrix()).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_LE((of("jaw").matrix() - jaw.matrix()).cwiseAbs().maxCoeff(), 1e-14);
    }
    EXPECT_EQ(model.movements()[0], 1.0 + 2.0);  // slide and jaw
    EXPECT_EQ(model.movements()[1], 1.0);
    EXPECT_EQ(model.movements()[2], 1.0 + 2.0);  // spin and follow
    const auto levers_m = model.levers_m(std::array{0.4, 2.0, 3.0});
    EXPECT_NEAR(levers_m.at(*model.find_link("jaw")), 0.2 + 0.4 + 0.05 + 2.0 * 0.4 + 0.1, 1e-12);
}

// Its sender may wrap a continuous joint: what moves with it must be at the same place then.
TEST(RobotModel, refuses_a_follower_that_a_full_turn_moves_elsewhere) {
    const auto fault_with = [](JointKind kind, double multiplier) {
        auto joints = tree_with_mimics();
        joints[0].kind = kind;
        joints[0].limits = {-1.0, 1.0};
        joints[0].mimic->multiplier = multiplier;
        const auto model = RobotModel::build("base", joints, kMoved);
        return model ? std::nullopt : std::optional(model.error().error);
    };
    for (const double whole : {-3.0, -1.0, 0.0, 1.0, 2.0}) {
        EXPECT_EQ(fault_with(JointKind::continuous, whole), std::nullopt) << whole;
        EXPECT_EQ(fault_with(JointKind::revolute, whole), std::nullopt) << whole;
    }
    for (const double part : {0.5, -0.5, 1.001}) {
        EXPECT_EQ(fault_with(JointKind::continuous, part), RobotModelError::mimic_of_turns) << part;
        EXPECT_EQ(fault_with(JointKind::revolute, part), RobotModelError::mimic_of_turns) << part;
    }
    EXPECT_EQ(fault_with(JointKind::prismatic, 1.0), RobotModelError::mimic_of_turns);
}

// Oracle: where a point of the link goes with a little of the joint.
TEST(RobotModel, tells_how_a_link_moves_with_each_joint) {
    const RobotModel model = built(tree_with_mimics());
    const std::array<double, 3> q = {0.2, -0.7, 1.3};
    constexpr double kLittle = 1e-6;
    const Vector3d p_link(0.3, -0.1, 0.2);
    std::vector<Isometry3d> T_base_link(model.link_count());
    std::vector<Isometry3d> moved(model.link_count());
    model.forward(q, T_base_link);
    for (const char* const link : {"base", "arm", "hand", "side", "tool", "leaf", "jaw"}) {
        const LinkId id = model.find_link(link).value();
        JointTwists twists;
        model.twists(id, T_base_link, twists);
        const Vector3d p = T_base_link[id] * p_link;
        for (std::size_t joint = 0; joint < kJointsMax; ++joint) {
            std::array<double, 3> further = q;
            if (joint < q.size()) further.at(joint) += kLittle;
            model.forward(further, moved);
            const Vector3d expected = (moved[id] * p_link - p) / kLittle;
            const Vector3d by_twist = twists.at(joint).turn.cross(p) + twists.at(joint).shift;
            EXPECT_LE((by_twist - expected).norm(), 1e-5) << link << ", joint " << joint;
            const JointTwist elsewhere =
                octoskin::placed(placed({1, 2, 0}, 0.4, {1, 2, 3}), twists.at(joint));
            const Vector3d p_elsewhere = placed({1, 2, 0}, 0.4, {1, 2, 3}) * p;
            EXPECT_NEAR((elsewhere.turn.cross(p_elsewhere) + elsewhere.shift).norm(), expected.norm(), 1e-5);
        }
    }
}

TEST(RobotModel, numbers_parents_before_children_and_keeps_the_order_of_moved_joints) {
    const RobotModel model = built(tree());
    EXPECT_EQ(model.find_link("base"), LinkId{0});
    EXPECT_LT(model.find_link("arm"), model.find_link("hand"));
    EXPECT_LT(model.find_link("hand"), model.find_link("tool"));
    EXPECT_FALSE(model.find_link("nobody"));
    ASSERT_EQ(model.limits().size(), 3U);
    EXPECT_EQ(model.limits()[0].max, 0.5);
    EXPECT_EQ(model.limits()[1].min, -2.0);
    EXPECT_EQ(model.limits()[2].max, std::numeric_limits<double>::infinity());
}

TEST(RobotModel, copy_computes_the_same) {
    const RobotModel model = built(tree());
    const RobotModel copy = model;
    std::vector<Isometry3d> ours(5), theirs(5);
    const std::array<double, 3> q = {0.1, -0.2, 0.3};
    model.forward(q, ours);
    copy.forward(q, theirs);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_TRUE(ours[i].matrix() == theirs[i].matrix());
}

TEST(RobotModel, moved_from_model_can_be_assigned_again) {
    const RobotModel model = built(tree());
    RobotModel target = model;
    const RobotModel taken = std::move(target);
    target = model;
    EXPECT_EQ(target.link_count(), 5U);
    target = RobotModel(taken);
    EXPECT_EQ(target.link_names()[0], "base");
}

TEST(RobotModel, each_error_has_words_of_its_own) {
    std::set<std::string> words;
    for (int error = 0; error <= static_cast<int>(RobotModelError::too_large); ++error) {
        words.insert(describe(static_cast<RobotModelError>(error)));
    }
    EXPECT_EQ(words.size(), static_cast<std::size_t>(RobotModelError::too_large) + 1U);
    EXPECT_FALSE(words.contains("unknown error"));
}

struct Refused {
    RobotModelError error;
    const char* element;
    void (*damage)(std::vector<JointDescription>& joints, std::vector<std::string>& moved);
};

TEST(RobotModel, refuses_each_fault_by_name) {
    using Joints = std::vector<JointDescription>;
    using Names = std::vector<std::string>;
    const Refused cases[] = {
        {RobotModelError::unknown_joint, "elbow", [](Joints&, Names& moved) { moved[1] = "elbow"; }},
        {RobotModelError::unknown_joint, "glued", [](Joints&, Names& moved) { moved.push_back("glued"); }},
        {RobotModelError::repeated_joint, "turn", [](Joints&, Names& moved) { moved.push_back("turn"); }},
        {RobotModelError::repeated_joint, "turn", [](Joints& joints, Names&) { joints[0].name = "turn"; }},
        {RobotModelError::unmoved_joint, "spin", [](Joints&, Names& moved) { moved.pop_back(); }},
        {RobotModelError::two_parents, "arm", [](Joints& joints, Names&) { joints[0].child_link = "arm"; }},
        {RobotModelError::two_parents, "base", [](Joints& joints, Names&) { joints[0].child_link = "base"; }},
        {RobotModelError::unreachable, "tool",
         [](Joints& joints, Names&) { joints[0].parent_link = "tool"; }},
        {RobotModelError::unreachable, "tool",
         [](Joints& joints, Names&) { joints[0].parent_link = "nobody"; }},
        {RobotModelError::non_unit_axis, "turn", [](Joints& joints, Names&) { joints[3].axis *= 1.01; }},
        {RobotModelError::non_unit_axis, "turn", [](Joints& joints, Names&) { joints[3].axis.setZero(); }},
        {RobotModelError::non_unit_axis, "turn", [](Joints& joints, Names&) { joints[3].axis.x() = kNaN; }},
        {RobotModelError::invalid_number, "glued",
         [](Joints& joints, Names&) { joints[0].T_parent_joint.translation().y() = kNaN; }},
        {RobotModelError::invalid_number, "glued",
         [](Joints& joints, Names&) { joints[0].T_parent_joint.linear() *= 1.01; }},
        {RobotModelError::invalid_number, "glued",
         [](Joints& joints, Names&) { joints[0].T_parent_joint.linear().col(0) *= -1.0; }},
        {RobotModelError::invalid_number, "turn",
         [](Joints& joints, Names&) {
             joints[3].limits = {1.0, -1.0};
         }},
        {RobotModelError::invalid_number, "turn",
         [](Joints& joints, Names&) { joints[3].limits.max = kNaN; }},
        {RobotModelError::invalid_number, "spin",
         [](Joints& joints, Names&) {
             joints[2].mimic = {"turn", kNaN, 0.0};
         }},
        {RobotModelError::bad_mimic, "spin",
         [](Joints& joints, Names&) {
             joints[2].mimic = {"spin", 1.0, 0.0};
         }},
        {RobotModelError::bad_mimic, "spin",
         [](Joints& joints, Names&) {
             joints[2].mimic = {"glued", 1.0, 0.0};
         }},
        {RobotModelError::bad_mimic, "spin",
         [](Joints& joints, Names&) {
             joints[2].mimic = {"elsewhere", 1.0, 0.0};
         }},
        {RobotModelError::unknown_joint, "spin",
         [](Joints& joints, Names&) {
             joints[2].mimic = {"turn", 1.0, 0.0};
         }},
    };
    for (const Refused& refused : cases) {
        auto joints = tree();
        auto moved = kMoved;
        refused.damage(joints, moved);
        const auto model = RobotModel::build("base", joints, moved);
        ASSERT_FALSE(model) << refused.element;
        EXPECT_EQ(model.error().error, refused.error) << describe(refused.error);
        EXPECT_EQ(model.error().element, refused.element) << describe(refused.error);
    }
}

TEST(RobotModel, refuses_more_than_1000_links) {
    std::vector<JointDescription> chain;
    std::string parent = "base";
    for (int i = 0; i < 1000; ++i) {
        JointDescription joint;
        joint.name = "joint" + std::to_string(i);
        joint.parent_link = parent;
        joint.child_link = parent = "link" + std::to_string(i);
        chain.push_back(joint);
    }
    const auto model = RobotModel::build("base", chain, {});
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().error, RobotModelError::too_large);
    chain.pop_back();
    EXPECT_TRUE(RobotModel::build("base", chain, {}));
}

}  // namespace
}  // namespace octoskin
