#include "host/core/ingest/local_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/wire/codec.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "tests/support/bus/scripted_bus.hpp"

namespace octoskin {
namespace {

constexpr wire::NodeId kNode = 10;

HostRig rig_of(std::size_t joints) {
    HostRig rig;
    rig.joint_sources = {{.node_id = kNode,
                          .joints = std::vector<std::string>(joints, "joint"),
                          .rate_hz = 100.0,
                          .is_local = true}};
    return rig;
}

class LocalJointsTest : public testing::Test {
  protected:
    LocalJointsTest() : intake_(rig_of(3)), joints_(kNode, 3, 100.0) {}

    FrameOutcome give(const wire::CanFrame& frame, std::int64_t at_ns) {
        return intake_.on_frame(frame, {test::kWallOffsetNs + at_ns});
    }
    void exchange(std::uint8_t sequence, std::int64_t at_ns) {
        give(wire::encode(wire::Sync{sequence}, wire::kHostId), at_ns);
        const auto host_time_us = static_cast<std::uint64_t>(at_ns / 1000);
        give(wire::encode(wire::FollowUp{sequence, host_time_us}, wire::kHostId), at_ns);
        give(joints_.report(sequence, {at_ns}), at_ns);
    }

    CanIntake intake_;
    LocalJoints joints_;
};

TEST_F(LocalJointsTest, come_out_of_the_intake_as_they_went_in_at_their_own_time) {
    const std::vector<double> position{0.123456, -3.0, 8.38};
    int compared = 0;
    for (int i = 0; i < 250; ++i) {  // 2.5 s at 100 Hz; they arrive 1 ms later
        const std::int64_t sampled = 1'000'000'000LL + i * 10'000'000LL;
        if (i % 100 == 0) exchange(static_cast<std::uint8_t>(i / 100), sampled);
        const auto frames = joints_.frames({sampled}, position);
        ASSERT_TRUE(frames);
        FrameOutcome outcome;
        for (const wire::CanFrame& frame : *frames) outcome = give(frame, sampled + 1'000'000);
        if (i < 130) continue;  // two exchanges, and the second one settled
        ASSERT_EQ(outcome.joint_samples.size(), 1U);
        ASSERT_TRUE(outcome.joint_samples[0]) << static_cast<int>(outcome.joint_samples[0].error());
        EXPECT_NEAR(static_cast<double>(outcome.joint_samples[0]->sampled.ns), static_cast<double>(sampled),
                    2000.0);
        for (std::size_t joint = 0; joint < position.size(); ++joint) {
            EXPECT_NEAR(outcome.joint_samples[0]->position_rad.at(joint), position[joint], 0.5e-6);
        }
        ++compared;
    }
    EXPECT_EQ(compared, 120);
}

TEST_F(LocalJointsTest, refuse_what_does_not_go_on_the_wire) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    std::int64_t now_ns = 0;
    const auto fault = [&](std::vector<double> position) {
        now_ns += 10'000'000;
        const auto frames = joints_.frames({now_ns}, position);
        return frames ? std::nullopt : std::optional(frames.error());
    };
    EXPECT_EQ(fault({0, 0}), LocalJointFault::wrong_count);
    EXPECT_EQ(fault({0, 0, 0, 0}), LocalJointFault::wrong_count);
    EXPECT_EQ(fault({0, nan, 0}), LocalJointFault::not_a_number);
    EXPECT_EQ(fault({0, 0, -infinity}), LocalJointFault::not_a_number);
    EXPECT_EQ(fault({8.388607, -8.388607, 0}), std::nullopt);
    EXPECT_EQ(fault({8.388608, 0, 0}), LocalJointFault::too_large);
    EXPECT_EQ(fault({0, -8.388608, 0}), LocalJointFault::too_large);
    EXPECT_EQ(fault({1e300, 0, 0}), LocalJointFault::too_large);
}

TEST_F(LocalJointsTest, are_thinned_to_about_the_rigs_rate_and_never_refused_for_it) {
    const std::vector<double> position{0.0, 0.0, 0.0};
    for (const double rate_hz : {50.0, 100.0, 125.0, 250.0, 1000.0}) {
        LocalJoints joints(kNode, 3, 100.0);
        int taken = 0;
        for (int i = 0; i < static_cast<int>(rate_hz); ++i) {
            const HostTime sampled{static_cast<std::int64_t>(i * 1e9 / rate_hz)};
            const auto frames = joints.frames(sampled, position);
            taken += frames ? 1 : 0;
            if (frames) continue;
            EXPECT_EQ(frames.error(), LocalJointFault::too_soon);
        }
        EXPECT_GE(taken, std::min(rate_hz, 100.0)) << rate_hz;
        EXPECT_LE(taken, 134) << rate_hz;
    }
}

}  // namespace
}  // namespace octoskin
