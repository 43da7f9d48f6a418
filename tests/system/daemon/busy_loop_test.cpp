// A daemon whose loop was held up, as by a large image: what came over CAN meanwhile is taken before what
// this machine measured since, whose time it tells. More of it waits than is taken in one turn, so that the
// order of turns decides nothing.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <functional>
#include <string_view>
#include <thread>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/inputs.hpp"
#include "host/apps/daemon/unix_socket.hpp"
#include "tests/system/daemon/daemon_fixture.hpp"

namespace octoskin::test {
namespace {

using namespace std::chrono_literals;

class BusyLoopTest : public testing::Test {
  protected:
    BusyLoopTest() : pipeline_(make_pipeline(request_, settings_).value()) {}

    /// A node of the rig that says nothing but that it lives.
    void heartbeats(int count) {
        const auto heartbeat = wire::encode(wire::Heartbeat{.state = wire::NodeState::ranging}, 1);
        for (int i = 0; i < count; ++i) EXPECT_TRUE(node_.send(heartbeat).value()) << "no room";
        const auto now = std::chrono::steady_clock::now();
        was_silent_ = was_silent_ || now - beat_ > kSilent;
        beat_ = now;
    }
    /// More than one turn takes, and then as a healthy bus goes on. False if this machine had no time for
    /// that: a bus that was silent, whose time nobody knows until the next SYNC.
    [[nodiscard]] bool hold_up(
        int steps, const std::function<void()>& beside = [] {}) {
        was_silent_ = false;
        heartbeats(300);
        for (int i = 0; i < steps; ++i) {
            std::this_thread::sleep_for(40ms);
            heartbeats(1);
            beside();
        }
        return !was_silent_;
    }
    /// The loop turns until `is_ready`, is held up by `busy`, again while that fails, and turns on until
    /// `is_over`. False if either takes too long.
    template <class IsReady, class Busy, class IsOver>
    bool run(const IsReady& is_ready, const Busy& busy, const IsOver& is_over) {
        Inputs inputs(request_, settings_.host.rig, loop_, pipeline_, recordings_);
        EXPECT_TRUE(inputs.take_sockets(settings_.host.rig));
        inputs.watch(settings_.host.rig);
        bool was_busy = false;
        const HostTime end = monotonic_now() + Nanoseconds(20s);
        const EventSource timer = loop_.every(10ms, [&] {
            if (was_busy && is_over(inputs)) loop_.stop(0);
            if (monotonic_now() > end) loop_.stop(1);
            if (was_busy) return;  // nobody attends: only turns of the loop take what came
            heartbeats(1);
            inputs.attend();
            was_busy = pipeline_.now() && is_ready(inputs) && busy();
        });
        return loop_.run() == 0;
    }

    /// An arm at rest.
    void tell_joints() const {
        constexpr std::string_view kAtRest = "0 0 0 -1.5 0 1.5 0";
        const auto socket = connect_unix_socket(request_.joint_socket, SOCK_DGRAM);
        ASSERT_TRUE(socket) << socket.error().message();
        EXPECT_EQ(::send(*socket, kAtRest.data(), kAtRest.size(), 0), static_cast<ssize_t>(kAtRest.size()));
        ::close(*socket);
    }

    static std::array<int, 2> make_bus() {
        std::array<int, 2> ends{};
        EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
        const int room = 1 << 20;
        EXPECT_EQ(::setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &room, sizeof(room)), 0);
        return ends;
    }

    /// A healthy bus is never silent for so long: see HostClockConfig::ahead_tolerance.
    static constexpr auto kSilent = 100ms;

    testing_support::ScratchFolder folder_;
    std::array<int, 2> bus_ = make_bus();
    socketcan::CanSocket node_{"node", bus_[1]};
    DaemonRequest request_{.rig = kExperiment,
                           .robot = {},
                           .can_descriptor = bus_[0],
                           .cameras = {record_wall(folder_).string()},
                           .joint_socket = folder_ / "joints",
                           .control_socket = {},
                           .map_folder = {}};
    Settings settings_ = read_settings(request_).value();
    EventLoop loop_;
    Pipeline pipeline_;
    RecordRequests recordings_;
    std::chrono::steady_clock::time_point beat_ = std::chrono::steady_clock::now();
    bool was_silent_ = false;
};

TEST_F(BusyLoopTest, takes_no_image_of_the_camera_for_one_of_the_future) {
    const auto& frames = pipeline_.inputs().depth_frames.front();
    std::uint64_t before = 0;
    ASSERT_TRUE(run([&](const Inputs&) { return frames.in() > 0; },
                    [&] {
                        before = frames.in();
                        return hold_up(50);
                    },
                    [&](const Inputs&) { return frames.in() > before + 2; }));
    EXPECT_EQ(frames.rejected(DepthReason::ahead_of_time), 0U);
}

// Each takes its place among the frames by when it came, and is dated by that.
TEST_F(BusyLoopTest, takes_joint_states_as_if_it_had_read_them_when_they_came) {
    const auto& samples = pipeline_.inputs().joint_samples;
    std::uint64_t used_before = 0;
    std::uint64_t rejected_before = 0;
    ASSERT_TRUE(run(
        [&](const Inputs&) {
            tell_joints();
            return samples.used() > 20;
        },
        [&] {
            used_before = samples.used();
            rejected_before = samples.rejected();
            return hold_up(8, [this] { tell_joints(); });
        },
        [&](const Inputs&) {
            return samples.used() + samples.rejected() >= used_before + rejected_before + 6;
        }));
    EXPECT_GE(samples.used(), used_before + 6);
    EXPECT_EQ(samples.rejected(), rejected_before);
    const HostClockEstimate& clock = pipeline_.intake().host_clock();
    EXPECT_EQ(clock.steps_back() + clock.stamps_ignored(), 0U);
}

}  // namespace
}  // namespace octoskin::test
