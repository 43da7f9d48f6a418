// What comes in while the daemon changes its mind.
#include "host/apps/daemon/inputs.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
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
    /// Ours alone is the bus then, and joint states come so often.
    void begin_with_rate(double joints_hz) {
        scene_.rig.joint_sources.at(0).rate_hz = joints_hz;
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
        other_end_.emplace("other", ends[0]);
        request_.can_descriptor = ends[1];
        slow_.reset();
        slow_ = inputs_with_joint_socket();
        slow_->watch(scene_.rig);
    }
    /// Frames of the bus every few milliseconds.
    void keep_bus_alive(std::chrono::duration<double> lasts) {
        const auto end = std::chrono::steady_clock::now() + lasts;
        do {
            ++bus_frames_;
            EXPECT_TRUE(other_end_->send(wire::encode(wire::FollowUp{1, 5'000'000}, wire::kHostId)).value());
            slow_->catch_up();
            std::this_thread::sleep_for(3ms);
        } while (std::chrono::steady_clock::now() < end);
    }
    [[nodiscard]] std::uint64_t frames_in() const { return beside_.inputs().frames.in(); }
    [[nodiscard]] const HostClockEstimate& host_clock() const { return beside_.intake().host_clock(); }

    std::unique_ptr<Inputs> slow_;
    std::uint64_t bus_frames_ = 0;
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

// Frames of the bus overtake what waits for the end of a burst.
TEST_F(InputsTest, joint_states_without_a_time_set_no_clock_back_whatever_their_rate) {
    constexpr int kSamples = 2;
    for (const double rate_hz : {1.0, 5.0, 10.0, 12.0, 14.5, 15.0, 16.0, 20.0, 50.0, 100.0, 1000.0}) {
        begin_with_rate(rate_hz);
        keep_bus_alive(10ms);
        const std::uint64_t before = frames_in() - bus_frames_;
        for (int i = 0; i < kSamples; ++i) {
            send_joints("0.5");
            keep_bus_alive(std::chrono::duration<double>(1.0 / rate_hz));
        }
        keep_bus_alive(20ms);
        EXPECT_EQ(frames_in() - bus_frames_ - before, kSamples * wire::kFramesPerJointSample) << rate_hz;
        EXPECT_EQ(host_clock().steps_back() + host_clock().stamps_ignored(), 0U) << rate_hz;
    }
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
