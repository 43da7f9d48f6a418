// What the daemon names as wrong with joint states and with the camera, likewise.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

namespace octoskin::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class JointProblemsTest : public DaemonViewTest {};

TEST_F(JointProblemsTest, have_a_joint_node_whose_word_does_not_count) {
    const auto with_heartbeat = [&](bool is_suspect) {
        play_changed([&](Scene& scene) {
            scene.bus.send(4.5,
                           wire::Heartbeat{.state = wire::NodeState::ranging, .is_time_suspect = is_suspect},
                           kJoints);
        });
        return all_reported();
    };
    EXPECT_THAT(with_heartbeat(false), IsEmpty());
    EXPECT_THAT(with_heartbeat(true), ElementsAre("node 10 'joints': time_suspect"));
    // Where it has sensors, too, it is one of the rig's nodes, and told as such.
    play_changed([&](Scene& scene) {
        scene.rig.nodes.push_back(scene.rig.nodes.front());
        scene.rig.nodes.back().node_id = kJoints;
        scene.bus.send(4.5, wire::Heartbeat{.state = wire::NodeState::ranging, .is_time_suspect = true},
                       kJoints);
    });
    EXPECT_THAT(all_reported(), ElementsAre("node 10 'node 1': time_suspect"));
}

TEST_F(JointProblemsTest, have_joint_states_without_a_time_where_nobody_tells_it) {
    play_changed(
        [](Scene& scene) {
            scene.bus = ScriptedBus{};
            scene.bus.joints(0.1, kJoints, std::array{0.2});
        },
        0.4);
    EXPECT_EQ(reported("no joints"), "no joint states: none from node 10 on the bus (and no --joints)");
    const auto with_socket = inputs_with_joint_socket();
    view_.inputs = with_socket.get();
    EXPECT_EQ(reported("no joints"),
              "no joint states: those that come through the socket have no time on the bus clock "
              "(joint_no_host_time): no host sends SYNC and FOLLOW_UP on the bus");
}

TEST_F(JointProblemsTest, have_joint_states_that_are_not_there_or_of_no_use) {
    play(daemon_scene(), 0.4);
    EXPECT_EQ(reported("no joints"), "no joint states: none from node 10 on the bus (and no --joints)");
    const auto with_socket = inputs_with_joint_socket();
    view_.inputs = with_socket.get();
    EXPECT_EQ(reported("no joints"),
              "no joint states: none comes through the socket; send them with `octoskin joints`");
    send_joints("half a turn");
    send_joints("1 2 3 4");
    with_socket->catch_up();
    EXPECT_EQ(reported("no joints"),
              "no joint states: the lines that come through the socket are refused (not_a_number 1, "
              "wrong_count 1, the newest of " +
                  describe(JointSender{::getpid(), ::getuid(), {}}) +
                  "); expected: [TIME] Q1 ... QN, radians (metres for a prismatic joint) in the rig's order; "
                  "TIME is CLOCK_MONOTONIC in seconds, within 1 s of now");
    Scene scene = daemon_scene();
    scene.bus = ScriptedBus{};
    for (int k = 0; k <= 8; ++k) scene.bus.exchange(0.1 + k, {kLeft});
    const double position = 0.0;
    for (int k = 0; k < 100; ++k) scene.bus.joints(3.0 + 0.01 * k, kJoints, {&position, 1});
    play(scene, 4.05);
    EXPECT_EQ(reported("no joints"), "");
    EXPECT_EQ(reported("joints unused"),
              "no joint state could be used: joint samples: 89 of 89 are not used, most as clock_not_ready "
              "(89): fewer than two SYNC exchanges with the node yet: usual in its first seconds. Wait some "
              "seconds, with the SYNC of a host on the bus.");
    EXPECT_EQ(reported("joints stopped"), "");
}

TEST_F(JointProblemsTest, have_joint_states_that_stopped_eight_tenths_of_a_second_ago) {
    EXPECT_EQ(reported("joints unused"), "");
    view_.now = *view_.used.joint_sample + Nanoseconds{800'000'000};
    EXPECT_EQ(reported("joints stopped"), "");
    view_.now = view_.now + kNs;
    EXPECT_EQ(reported("joints stopped"), "joint states have stopped: readings have no pose");
    EXPECT_EQ(reported("no joints") + reported("joints unused"), "");
}

TEST_F(JointProblemsTest, have_joint_states_that_are_too_slow_but_no_single_gap_between_them) {
    MapBuilder& builder = pipeline_->builder();
    const auto add = [&](double at_s) { EXPECT_TRUE(builder.add({host_at(at_s), {M_PI / 2.0}})); };
    add(5.0);
    for (int gaps = 1; gaps <= 4; ++gaps) {
        const double at_s = 5.0 + 0.15 * gaps;
        add(at_s);
        for (const double before_s : {0.07, 0.06}) {
            EXPECT_FALSE(
                builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, host_at(at_s - before_s), 0.52, 0.02}));
        }
        set_now(at_s);
        EXPECT_EQ(reported("joint gap"),
                  gaps < 3 ? ""
                           : "readings have no pose (joints_missing). Joint samples are 150 ms "
                             "apart; at most 100 ms are bridged, and 50 ms to the nearer one.");
    }
    set_now(8.7);
    EXPECT_EQ(reported("joint gap"), "") << "it is over";
}

TEST_F(JointProblemsTest, have_a_joint_beyond_its_limits_and_which) {
    const double position = 3.3;
    play_changed(
        [&](Scene& scene) {
            for (int k = 0; k < 5; ++k) scene.bus.joints(9.05 + 0.01 * k, kJoints, {&position, 1});
            scene.bus.exchange(9.12, {kLeft, kRight, kJoints});
            for (int k = 0; k < 20; ++k) scene.bus.heartbeat(9.0 + 0.02 * k, scene.rig.nodes.front());
        },
        9.3);
    EXPECT_EQ(reported("joints beyond limits"),
              "joint samples beyond the limits are not used: shoulder is 3.3; its limits are -3.2 to 3.2");
}

TEST_F(JointProblemsTest, have_joint_states_that_come_quicker_than_the_rig_says) {
    const auto at_rate_of_rig = [&](double rate_hz) {
        play_changed([&](Scene& scene) { scene.rig.joints.rate_hz = rate_hz; });
        return reported("joints too frequent");
    };
    EXPECT_EQ(at_rate_of_rig(100.0), "");
    EXPECT_THAT(
        at_rate_of_rig(55.0),
        testing::MatchesRegex("joint states come, or came, faster than the 55 Hz of the rig, and were "
                              "refused \\(too_frequent, [0-9]+\\): set joints.rate_hz to the true rate"));
}

/// From `begin_s` to `end_s` every second sample once more, 6 ms before, with the first joint `off` the
/// truth.
void add_second_sender(Scene& scene, double begin_s, double end_s, double off) {
    ScriptedBus other;
    other.set_clock(kJoints, 123'456'789, -60e-6);
    for (double t = begin_s; t < end_s; t += 0.02) {
        const double position = angle_at(t) + off;
        other.joints(t - 0.006, kJoints, {&position, 1});
    }
    for (const StampedFrame& entry : other.frames())
        scene.bus.send(1e-9 * static_cast<double>(entry.stamp.ns - kWallOffsetNs), entry.frame);
}

TEST_F(JointProblemsTest, have_two_senders_under_the_joint_node_from_the_first_contradiction_on) {
    const auto with_second = [&](double end_s, double now_s) {
        play_changed([&](Scene& scene) { add_second_sender(scene, 4.3, end_s, 0.05); }, now_s);
        return reported("joint senders");
    };
    EXPECT_EQ(with_second(4.9, 4.29), "");
    EXPECT_THAT(with_second(4.9, 4.4),
                testing::MatchesRegex(
                    "two senders send joint states under node 10, and neither is used until they have not "
                    "contradicted each other for a second \\(second_sender, [0-9]+\\): the joint node and "
                    "another board of that id, or `octoskin joints --can` beside it"));
    EXPECT_EQ(problems(view_).front().about, "joint senders");
    EXPECT_NE(with_second(4.4, 6.5), "") << "for three seconds after the last that was withheld";
    EXPECT_EQ(with_second(4.4, 8.5), "");
}

TEST_F(JointProblemsTest, have_a_joint_that_jumps_and_by_how_much) {
    play_changed(
        [](Scene& scene) {
            for (const auto& [at_s, position] : {std::pair{9.05, 0.0}, std::pair{9.06, angle_at(9.0)}})
                scene.bus.joints(at_s, kJoints, {&position, 1});
            scene.bus.exchange(9.1, {kLeft, kRight, kJoints});
            for (int k = 0; k < 20; ++k) scene.bus.heartbeat(9.0 + 0.02 * k, scene.rig.nodes.front());
        },
        9.3);
    EXPECT_EQ(reported("joint jump"),
              "joint states jump: shoulder went from 2.371 to 0.000 in 50 ms, but the robot description "
              "allows at most 0.850 (joint_jump, 1): another program sends joint states too, or the velocity "
              "of its <limit> is too low");
    EXPECT_EQ(reported("joint senders"), "") << "one alone is nobody";
}

TEST_F(JointProblemsTest, have_every_program_that_sends_to_the_socket_where_there_are_several) {
    const auto with_socket = inputs_with_joint_socket();
    view_.inputs = with_socket.get();
    send_joints("0.5");
    with_socket->catch_up();
    view_.now = monotonic_now();
    EXPECT_EQ(reported("joint senders"), "");
    const pid_t child = ::fork();
    if (child == 0) {
        send_joints("0.7");
        ::_exit(0);
    }
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    with_socket->catch_up();
    view_.now = monotonic_now();
    EXPECT_THAT(reported("joint senders"),
                testing::MatchesRegex(
                    fmt::format("joint states come through the socket from more than one program, and none "
                                "is used until all but one have been silent for a second \\(second_sender, "
                                "1\\): process {} \\(.*, user {}\\) and process {} \\(.*user {}\\)",
                                ::getpid(), ::getuid(), child, ::getuid())));
    EXPECT_TRUE(are_joints_withheld(view_));
    view_.now = view_.now + Nanoseconds{1'000'000'000};
    EXPECT_FALSE(are_joints_withheld(view_));
    view_.now = view_.now + Nanoseconds{2'000'000'000};
    EXPECT_EQ(reported("joint senders"), "");
}

class CameraProblemsTest : public DaemonViewTest {};

TEST_F(CameraProblemsTest, have_a_camera_whose_frames_are_of_no_use_or_stopped) {
    EXPECT_EQ(reported("depth unused"), "");
    const auto look_after = [&](Nanoseconds duration) {
        view_.now = *view_.used.depth_frame + duration;
        view_.camera->newest = view_.now;
        return reported("depth stopped");
    };
    EXPECT_EQ(look_after(Nanoseconds{800'000'000}), "");
    EXPECT_EQ(look_after(Nanoseconds{800'000'001}),
              "depth frames no longer reach the map: see the counters of depth frames");
    view_.camera->newest = view_.now - kSecond;
    EXPECT_EQ(reported("depth stopped"), "") << "its own fault is told first";
    EXPECT_EQ(reported("camera silent"), "camera: no frame for three periods");
    play(daemon_scene(), 3.95);
    view_.camera->newest = view_.now;
    EXPECT_EQ(reported("depth unused"), "") << "none has come";
    play_changed([](Scene& scene) { scene.rig.camera->T_base_camera.translation().x() = 2000.0; });
    view_.camera->newest = view_.now;
    EXPECT_EQ(reported("depth unused"),
              "no depth frame could be used yet: depth frames: 6 of 6 are lost, most as outside_map (6): the "
              "camera is outside the octree, or its pose is not a number. Correct the camera's pose.");
    EXPECT_EQ(reported("depth of another size"), "");
    play_changed([](Scene& scene) { scene.rig.camera->intrinsics.width = 17; });
    view_.camera->newest = view_.now;
    EXPECT_EQ(reported("depth of another size"),
              "camera: none of its images is 17 x " + std::to_string(scene_.rig.camera->intrinsics.height) +
                  ", as the rig has it (wrong_size): set camera.width_px and camera.height_px of the rig to "
                  "those of one of its modes (`octoskin cameras` lists them)");
    EXPECT_EQ(reported("depth unused"), "");
}

TEST_F(CameraProblemsTest, have_images_that_there_is_no_time_for_once_that_has_lasted_two_seconds) {
    const auto is_reported = [this](Nanoseconds lasted, Nanoseconds ago) {
        view_.used.depth_left_out = view_.now - ago;
        view_.used.depth_left_out_since = *view_.used.depth_left_out - lasted;
        return !reported("depth left out").empty();
    };
    EXPECT_TRUE(is_reported(2 * kSecond + kNs, kSecond - kNs));
    EXPECT_NE(reported("depth left out").find("(queue_overflow): use a coarser resolution_m"),
              std::string::npos);
    EXPECT_FALSE(is_reported(2 * kSecond, kSecond - kNs)) << "a busy moment";
    EXPECT_FALSE(is_reported(2 * kSecond + kNs, kSecond)) << "it keeps up again";
    view_.used.depth_left_out.reset();
    EXPECT_EQ(reported("depth left out"), "");
}

/// A pipeline whose worker never ends its first image: of those that come, two wait and the oldest goes.
TEST_F(CameraProblemsTest, know_since_when_images_have_been_left_out_again_and_again) {
    class Stuck final : public DepthWorker {
        void begin(std::function<void()> work) override { work_ = std::move(work); }
        [[nodiscard]] bool is_done() const override { return false; }
        void finish() override { work_(); }
        std::function<void()> work_;
    } worker;
    const Scene scene = daemon_scene();
    Pipeline pipeline = make_pipeline(scene);
    pipeline.work_beside(&worker);
    for (const StampedFrame& entry : scene.bus.frames()) pipeline.on_can(entry.frame, entry.stamp);
    const auto at = [](double seconds) { return HostTime{std::llround(seconds * 1e9)}; };
    auto leave_one_out_at = [&, used = LastUsed{}, captured = 4.0](double at_s) mutable {
        DepthFrame frame = flat_frame(captured += 0.01);
        pipeline.on_depth(std::move(frame));
        used.note(pipeline, at(at_s));
        return used;
    };
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(leave_one_out_at(9.0).depth_left_out) << i;
    EXPECT_EQ(leave_one_out_at(10.0).depth_left_out_since, at(10.0));
    EXPECT_EQ(leave_one_out_at(11.0).depth_left_out_since, at(10.0)) << "at least once a second";
    const LastUsed later = leave_one_out_at(12.5);
    EXPECT_EQ(later.depth_left_out, at(12.5));
    EXPECT_EQ(later.depth_left_out_since, at(12.5)) << "for a second and a half there was time for all";
    pipeline.finish();
}

TEST_F(CameraProblemsTest, have_nothing_of_a_camera_that_nobody_wants) {
    view_.now = *view_.used.depth_frame + kSecond;
    EXPECT_EQ(reported("camera silent"), "camera: no frame for three periods");
    view_.camera.reset();
    EXPECT_EQ(reported("camera silent") + reported("depth stopped"), "");
}

TEST_F(CameraProblemsTest, have_a_camera_beside_a_bus_that_fell_silent) {
    play_changed([](Scene& scene) { scene.rig.camera->intrinsics.width = 17; });
    ScriptedBus bus;
    bus.heartbeat(0.0, node_of(scene_, kLeft));
    say(bus.frames().front().frame);
    view_.now = monotonic_now() + kSecond;
    view_.camera->newest = view_.now;
    EXPECT_EQ(reported("depth beside silent bus"),
              "camera: its frames are not used, because the bus is silent: no node sends joint states for "
              "the robot's pose (joints_missing)");
    EXPECT_EQ(reported("depth of another size"), "");
    view_.now = monotonic_now();
    view_.camera->newest = view_.now;
    EXPECT_EQ(reported("depth beside silent bus"), "");
    EXPECT_NE(reported("depth of another size"), "");
}

TEST_F(CameraProblemsTest, have_a_camera_without_a_time_until_three_exchanges_of_the_other_host_agree) {
    view_.is_listen_only = true;
    const std::string expected =
        "camera: its frames have no time: the clock of the host that sends SYNC is not known, or in doubt "
        "(three "
        "FOLLOW_UPs must agree)";
    for (std::uint8_t sequence = 1; sequence <= 3; ++sequence) {
        EXPECT_EQ(reported("camera untimed"), expected);
        const HostTime heard = say_sync(sequence);
        say(wire::encode(wire::FollowUp{sequence, static_cast<std::uint64_t>(heard.ns / 1'000) + 900'000'000},
                         wire::kHostId));
        view_.now = heard;
        view_.camera->newest = view_.used.depth_frame = heard;
    }
    EXPECT_EQ(reported("camera untimed"), "");
    view_.now = view_.now + 6 * kSecond;
    view_.camera->newest = view_.now;
    EXPECT_EQ(reported("camera untimed"), expected) << "it is silent again";
}

}  // namespace
}  // namespace octoskin::test
