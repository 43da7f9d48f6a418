// What comes in while the daemon changes its mind.
#include "host/apps/daemon/inputs.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;

class InputsTest : public DaemonViewTest {
  protected:
    [[nodiscard]] std::uint64_t frames_in() const { return beside_.accounts().frames.in(); }
};

// By the order of the next rig's joints they would be a pose that never was.
TEST_F(InputsTest, joint_states_that_wait_are_of_the_rig_that_held_when_they_came) {
    const auto inputs = inputs_with_joint_socket();
    send_joints("0.5");
    inputs->prepare_for(scene_.rig);
    EXPECT_EQ(inputs->joints()->samples(), 1U);
    const std::uint64_t before = frames_in();
    EXPECT_GT(before, 0U) << "they went to the former pipeline";
    inputs->change_rig(scene_.rig);
    std::this_thread::sleep_for(20ms);  // or it comes too soon after the first
    send_joints("0.6");
    inputs->catch_up();
    EXPECT_GT(frames_in(), before) << "those that come now are the new rig's";
    EXPECT_EQ(inputs->joints_displaced(), 0U);
}

// Of a flood more waits than is taken in one turn.
TEST_F(InputsTest, joint_states_from_before_a_reload_that_come_to_light_after_it_are_left_out) {
    const auto inputs = inputs_with_joint_socket();
    for (int i = 0; i < 5; ++i) send_joints("0.5");
    inputs->change_rig(scene_.rig);
    inputs->catch_up();
    EXPECT_EQ(frames_in(), 0U);
    EXPECT_EQ(inputs->joints_displaced(), 5U);
}

// A host that sends SYNC itself knows when that was on the bus.
TEST_F(InputsTest, another_host_s_follow_up_is_left_out_unless_this_one_only_listens) {
    const auto say_follow_up = [this](std::uint8_t flipped) {
        wire::CanFrame frame = wire::encode(wire::FollowUp{1, 5'000'000}, wire::kHostId);
        frame.data[3] ^= flipped;
        say(frame);
    };
    say_follow_up(0);
    EXPECT_EQ(inputs_->foreign_follow_ups(), 0U);
    EXPECT_EQ(frames_in(), 1U);
    request_.is_listen_only = false;
    EXPECT_FALSE(inputs_->foreign_sync());
    say_follow_up(0);
    EXPECT_EQ(inputs_->foreign_follow_ups(), 1U);
    EXPECT_TRUE(inputs_->foreign_sync());
    EXPECT_EQ(frames_in(), 1U);
    say_follow_up(1);
    EXPECT_EQ(inputs_->foreign_follow_ups(), 1U);
    EXPECT_EQ(frames_in(), 2U) << "wrong_crc";
}

// The camera's images are on that host's clock, too: by this machine's they would never grow old.
TEST_F(InputsTest, the_time_is_that_of_another_host_where_no_node_speaks) {
    constexpr std::int64_t kAheadNs = 900'000'000'000'000;
    for (std::uint8_t sequence = 1; sequence <= 3; ++sequence) {
        const HostTime heard = say_sync(sequence);
        const auto us = static_cast<std::uint64_t>((heard.ns + kAheadNs) / 1'000);
        say(wire::encode(wire::FollowUp{sequence, us}, wire::kHostId));
    }
    const HostTime now = monotonic_now();
    ASSERT_TRUE(inputs_->bus_now(now));
    const auto ahead_s = [&] {
        return static_cast<double>((inputs_->reckoned_bus_now(now) - now).count()) * 1e-9;
    };
    EXPECT_NEAR(ahead_s(), 900'000.0, 1.0);
    std::this_thread::sleep_for(50ms);
    wire::CanFrame broken = wire::encode(wire::Sync{9}, wire::kHostId);
    broken.payload_len = 0;
    const double before = ahead_s();
    say(broken);
    EXPECT_EQ(ahead_s(), before) << "it tells nothing";
}

}  // namespace
}  // namespace octoskin::test
