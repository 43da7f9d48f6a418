#include "host/core/kinematics/self_hit.hpp"

#include <gtest/gtest.h>

#include <array>

namespace octoskin {
namespace {

/// A post along z at x = 1 (link 1) and a ball at x = 3 (link 2).
const std::array<PosedCapsule, 2> kBody = {PosedCapsule{{1, 0, -1}, {1, 0, 1}, 0.25, 1},
                                           PosedCapsule{{3, 0, 0}, {3, 0, 0}, 0.5, 2}};

TEST(SelfHit, is_the_nearest_capsule_along_the_beam) {
    EXPECT_DOUBLE_EQ(predict_self_hit(kBody, {0, 0, 0}, {1, 0, 0}, {}).value(), 0.75);
    EXPECT_DOUBLE_EQ(predict_self_hit(kBody, {5, 0, 0}, {-1, 0, 0}, {}).value(), 1.5);
}

TEST(SelfHit, leaves_out_the_ignored_links) {
    const std::array<LinkId, 1> post = {1};
    EXPECT_DOUBLE_EQ(predict_self_hit(kBody, {0, 0, 0}, {1, 0, 0}, post).value(), 2.5);
    const std::array<LinkId, 2> both = {2, 1};
    EXPECT_FALSE(predict_self_hit(kBody, {0, 0, 0}, {1, 0, 0}, both));
}

TEST(SelfHit, beam_that_misses_or_leads_away_has_none) {
    EXPECT_FALSE(predict_self_hit(kBody, {0, 0, 0}, {-1, 0, 0}, {}));
    EXPECT_FALSE(predict_self_hit(kBody, {0, 0.6, 0}, {1, 0, 0}, {}));
    EXPECT_FALSE(predict_self_hit({}, {0, 0, 0}, {1, 0, 0}, {}));
}

TEST(SelfHit, beam_that_starts_inside_the_body_hits_at_zero) {
    EXPECT_EQ(predict_self_hit(kBody, {1.1, 0, 0}, {1, 0, 0}, {}).value(), 0.0);
}

RobotModel two_links() {
    JointDescription joint;
    joint.name = "turn";
    joint.parent_link = "base";
    joint.child_link = "arm";
    joint.kind = JointKind::continuous;
    joint.T_parent_joint.translation().z() = 1.0;
    const std::array joints = {joint};
    const std::array<std::string, 1> moved = {"turn"};
    return RobotModel::build("base", joints, moved).value();
}

TEST(RobotBody, capsules_move_with_their_links) {
    const RobotModel model = two_links();
    const std::array capsules = {LinkCapsule{"arm", {0, 0, 0}, {1, 0, 0}, 0.1},
                                 LinkCapsule{"base", {0, 0, 0}, {0, 0, 1}, 0.2}};
    const auto body = RobotBody::build(capsules, model);
    ASSERT_TRUE(body);
    std::vector<Eigen::Isometry3d> T_base_link(2);
    model.forward(std::array{1.5707963267948966}, T_base_link);
    std::vector<PosedCapsule> posed(7);
    body->pose(T_base_link, posed);
    ASSERT_EQ(posed.size(), 2U);
    EXPECT_TRUE(posed[0].p_a.isApprox(Eigen::Vector3d(0, 0, 1)));
    EXPECT_TRUE(posed[0].p_b.isApprox(Eigen::Vector3d(0, 1, 1)));
    EXPECT_EQ(posed[0].radius_m, 0.1);
    EXPECT_EQ(posed[0].link, model.find_link("arm"));
    EXPECT_TRUE(posed[1].p_b.isApprox(Eigen::Vector3d(0, 0, 1)));
    EXPECT_EQ(posed[1].link, 0);
}

TEST(RobotBody, refuses_a_capsule_on_a_link_that_the_model_lacks) {
    const std::array capsules = {LinkCapsule{"gripper", {0, 0, 0}, {1, 0, 0}, 0.1}};
    const auto body = RobotBody::build(capsules, two_links());
    ASSERT_FALSE(body);
    EXPECT_EQ(body.error().element, "gripper");
}

}  // namespace
}  // namespace octoskin
