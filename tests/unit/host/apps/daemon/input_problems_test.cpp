// The daemon's problems of joint states and of the camera: their codes and figures, when each begins and
// ends.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "common/wire/codec.hpp"
#include "host/apps/daemon/clocks.hpp"
#include "tests/unit/host/apps/daemon/daemon_view_fixture.hpp"

namespace octoskin::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Optional;

/// The condition matches a regular expression.
auto what_matches(const std::string& pattern) {
    return testing::Field("what", &Problem::what, testing::MatchesRegex(pattern));
}

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
    EXPECT_THAT(with_heartbeat(true), ElementsAre(is_unusable_node("node 10 'joints': time_suspect")));
    // Where it has sensors, too, it is one of the rig's nodes, and told as such.
    play_changed([&](Scene& scene) {
        scene.rig.nodes.push_back(scene.rig.nodes.front());
        scene.rig.nodes.back().node_id = kJoints;
        scene.bus.send(4.5, wire::Heartbeat{.state = wire::NodeState::ranging, .is_time_suspect = true},
                       kJoints);
    });
    EXPECT_THAT(all_reported(), ElementsAre(is_unusable_node("node 10 'node 1': time_suspect")));
}

TEST_F(JointProblemsTest, have_joint_states_without_a_time_where_nobody_tells_it) {
    play_changed(
        [](Scene& scene) {
            scene.bus = ScriptedBus{};
            scene.bus.joints(0.1, kJoints, std::array{0.2});
        },
        0.4);
    EXPECT_THAT(reported(ProblemCode::joints_missing),
                Optional(AllOf(what_has("node 10"), what_has("--joints"))));
    const auto with_socket = inputs_with_joint_socket();
    view_.inputs = with_socket.get();
    EXPECT_THAT(reported(ProblemCode::joints_missing),
                Optional(AllOf(key_is("joint_no_host_time"), what_has("SYNC"), what_has("FOLLOW_UP"))));
}

TEST_F(JointProblemsTest, have_joint_states_that_are_not_there_or_of_no_use) {
    play(daemon_scene(), 0.4);
    EXPECT_THAT(reported(ProblemCode::joints_missing),
                Optional(AllOf(what_has("node 10"), what_has("--joints"))));
    const auto with_socket = inputs_with_joint_socket();
    view_.inputs = with_socket.get();
    EXPECT_THAT(reported(ProblemCode::joints_missing),
                Optional(AllOf(what_has("socket"), remedy_has("`octoskin joints`"),
                               remedy_has("`octoskin bridge`"))));
    send_joints("half a turn");
    send_joints("1 2 3 4");
    with_socket->catch_up();
    EXPECT_THAT(reported(ProblemCode::joints_missing),
                Optional(AllOf(what_has("(not_a_number 1, wrong_count 1, the newest of " +
                                        describe(JointSender{::getpid(), ::getuid(), {}}) + ")"),
                               remedy_has("[TIME] Q1 ... QN"), remedy_has("CLOCK_MONOTONIC"))));
    Scene scene = daemon_scene();
    scene.bus = ScriptedBus{};
    for (int k = 0; k <= 8; ++k) scene.bus.exchange(0.1 + k, {kLeft});
    const double position = 0.0;
    for (int k = 0; k < 100; ++k) scene.bus.joints(3.0 + 0.01 * k, kJoints, {&position, 1});
    play(scene, 4.05);
    EXPECT_EQ(reported(ProblemCode::joints_missing), std::nullopt);
    EXPECT_THAT(reported(ProblemCode::joints_unused),
                Optional(AllOf(what_has("89 of 89"), what_has("clock_not_ready (89)"), what_has("SYNC"))));
    EXPECT_EQ(reported(ProblemCode::joints_stopped), std::nullopt);
}

TEST_F(JointProblemsTest, have_joint_states_that_stopped_eight_tenths_of_a_second_ago) {
    EXPECT_EQ(reported(ProblemCode::joints_unused), std::nullopt);
    view_.now = *view_.used.joint_sample + Nanoseconds{800'000'000};
    EXPECT_EQ(reported(ProblemCode::joints_stopped), std::nullopt);
    view_.now = view_.now + kNs;
    EXPECT_NE(reported(ProblemCode::joints_stopped), std::nullopt);
    EXPECT_EQ(reported(ProblemCode::joints_missing), std::nullopt);
    EXPECT_EQ(reported(ProblemCode::joints_unused), std::nullopt);
}

TEST_F(JointProblemsTest, have_joint_states_of_more_joints_than_the_rig_has) {
    play_changed(
        [](Scene& scene) {
            for (int k = 0; k < 150; ++k) {
                scene.bus.joints(9.02 + 0.01 * k, kJoints, std::array{angle_at(9.0), 0.1});
                scene.bus.heartbeat(9.02 + 0.01 * k, scene.rig.nodes.front());
            }
            scene.bus.exchange(9.1, {kLeft, kRight, kJoints});
            scene.bus.exchange(10.1, {kLeft, kRight, kJoints});
        },
        10.5);
    EXPECT_THAT(reported(ProblemCode::joints_stopped),
                Optional(AllOf(key_is("wrong_count"), what_matches(".*\\(wrong_count, [0-9]+\\)"))));
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
        const auto gap = reported(ProblemCode::joint_gap);
        EXPECT_EQ(gap.has_value(), gaps >= 3) << gaps;
        if (!gap) continue;
        EXPECT_THAT(*gap, AllOf(key_is("joints_missing"), what_has("150 ms"), what_has("100 ms"),
                                what_has("50 ms to the nearer one")));
    }
    set_now(8.7);
    EXPECT_EQ(reported(ProblemCode::joint_gap), std::nullopt) << "it is over";
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
    EXPECT_THAT(reported(ProblemCode::joint_limits),
                Optional(AllOf(what_has("shoulder is 3.3;"), what_has("-3.2 to 3.2"))));
}

TEST_F(JointProblemsTest, have_joint_states_that_come_quicker_than_the_rig_says) {
    const auto at_rate_of_rig = [&](double rate_hz) {
        play_changed([&](Scene& scene) { scene.rig.joint_sources.at(0).rate_hz = rate_hz; });
        return reported(ProblemCode::joints_too_frequent);
    };
    EXPECT_EQ(at_rate_of_rig(100.0), std::nullopt);
    EXPECT_THAT(at_rate_of_rig(55.0), Optional(AllOf(key_is("joints.rate_hz"), what_has("55 Hz"),
                                                     what_matches(".*\\(too_frequent, [0-9]+\\).*"),
                                                     remedy_has("joints.rate_hz"))));
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
        return reported(ProblemCode::joint_senders);
    };
    EXPECT_EQ(with_second(4.9, 4.29), std::nullopt);
    EXPECT_THAT(with_second(4.9, 4.4), Optional(AllOf(key_is("second_sender"), what_has("under node 10"),
                                                      what_matches(".*\\(second_sender, [0-9]+\\).*"),
                                                      what_has("`octoskin joints --can`"))));
    EXPECT_EQ(all_reported().front().code, ProblemCode::joint_senders);
    EXPECT_NE(with_second(4.4, 6.5), std::nullopt) << "for three seconds after the last that was withheld";
    EXPECT_EQ(with_second(4.4, 8.5), std::nullopt);
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
    EXPECT_THAT(reported(ProblemCode::joint_jump),
                Optional(AllOf(key_is("joint_jump"), what_has("shoulder went from 2.371 to 0.000 in 50 ms"),
                               what_has("at most 0.850"), what_has("(joint_jump, 1)"), what_has("<limit>"))));
    EXPECT_EQ(reported(ProblemCode::joint_senders), std::nullopt) << "one alone is nobody";
}

TEST_F(JointProblemsTest, have_every_program_that_sends_to_the_socket_where_there_are_several) {
    const auto with_socket = inputs_with_joint_socket();
    view_.inputs = with_socket.get();
    send_joints("0.5");
    with_socket->catch_up();
    view_.now = monotonic_now();
    EXPECT_EQ(reported(ProblemCode::joint_senders), std::nullopt);
    const pid_t child = ::fork();
    if (child == 0) {
        send_joints("0.7");
        ::_exit(0);
    }
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    with_socket->catch_up();
    view_.now = monotonic_now();
    EXPECT_THAT(reported(ProblemCode::joint_senders),
                Optional(AllOf(key_is("second_sender"), what_has("socket"), what_has("(second_sender, 1)"),
                               what_matches(fmt::format(
                                   ".*: process {} \\(.*, user {}\\) and process {} \\(.*user {}\\)",
                                   ::getpid(), ::getuid(), child, ::getuid())))));
    EXPECT_TRUE(are_joints_withheld(view_));
    view_.now = view_.now + Nanoseconds{1'000'000'000};
    EXPECT_FALSE(are_joints_withheld(view_));
    view_.now = view_.now + Nanoseconds{2'000'000'000};
    EXPECT_EQ(reported(ProblemCode::joint_senders), std::nullopt);
}

class CameraProblemsTest : public DaemonViewTest {};

TEST_F(CameraProblemsTest, have_a_camera_whose_frames_are_of_no_use_or_stopped) {
    EXPECT_EQ(reported(ProblemCode::depth_unused), std::nullopt);
    const auto look_after = [&](Nanoseconds duration) {
        view_.now = *view_.used.cameras[0].frame + duration;
        view_.cameras[0].newest = view_.now;
        return reported(ProblemCode::depth_stopped);
    };
    EXPECT_EQ(look_after(Nanoseconds{800'000'000}), std::nullopt);
    EXPECT_THAT(look_after(Nanoseconds{800'000'001}), Optional(what_has("counters of depth frames")));
    view_.cameras[0].newest = view_.now - kSecond;
    EXPECT_EQ(reported(ProblemCode::depth_stopped), std::nullopt) << "its own fault is told first";
    EXPECT_NE(reported(ProblemCode::camera_silent, "camera"), std::nullopt);
    play(daemon_scene(), 3.95);
    view_.cameras[0].newest = view_.now;
    EXPECT_EQ(reported(ProblemCode::depth_unused), std::nullopt) << "none has come";
    play_changed([](Scene& scene) { scene.rig.cameras.front().T_link_camera.translation().x() = 2000.0; });
    view_.cameras[0].newest = view_.now;
    EXPECT_THAT(reported(ProblemCode::depth_unused),
                Optional(AllOf(what_has("6 of 6"), what_has("outside_map (6)"), what_has("camera's pose"))));
    EXPECT_EQ(reported(ProblemCode::camera_size), std::nullopt);
    play_changed([](Scene& scene) { scene.rig.cameras.front().intrinsics.width = 17; });
    view_.cameras[0].newest = view_.now;
    EXPECT_THAT(
        reported(ProblemCode::camera_size, "camera"),
        Optional(AllOf(key_is("wrong_size"),
                       what_has("17 x " + std::to_string(scene_.rig.cameras.front().intrinsics.height)),
                       what_has("are 16 x 12"), remedy_has("width_px"), remedy_has("height_px"),
                       remedy_has("`octoskin cameras`"))));
    EXPECT_EQ(reported(ProblemCode::depth_unused), std::nullopt);
}

TEST_F(CameraProblemsTest, have_images_that_there_is_no_time_for_once_that_has_lasted_two_seconds) {
    const auto is_reported = [this](Nanoseconds lasted, Nanoseconds ago) {
        view_.used.cameras[0].left_out = view_.now - ago;
        view_.used.cameras[0].left_out_since = *view_.used.cameras[0].left_out - lasted;
        return reported(ProblemCode::camera_overload, "camera").has_value();
    };
    EXPECT_TRUE(is_reported(2 * kSecond + kNs, kSecond - kNs));
    EXPECT_THAT(reported(ProblemCode::camera_overload),
                Optional(AllOf(key_is("queue_overflow"), remedy_has("resolution_m"))));
    EXPECT_FALSE(is_reported(2 * kSecond, kSecond - kNs)) << "a busy moment";
    EXPECT_FALSE(is_reported(2 * kSecond + kNs, kSecond)) << "it keeps up again";
    view_.used.cameras[0].left_out.reset();
    EXPECT_EQ(reported(ProblemCode::camera_overload), std::nullopt);
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
    pipeline.work_beside({&worker});
    for (const StampedFrame& entry : scene.bus.frames()) pipeline.on_can(entry.frame, entry.stamp);
    const auto at = [](double seconds) { return HostTime{std::llround(seconds * 1e9)}; };
    auto leave_one_out_at = [&, used = LastUsed{}, captured = 4.0](double at_s) mutable {
        DepthFrame frame = flat_frame(captured += 0.01);
        pipeline.on_depth(std::move(frame));
        used.note(pipeline, scene.rig, at(at_s));
        return used;
    };
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(leave_one_out_at(9.0).cameras[0].left_out) << i;
    EXPECT_EQ(leave_one_out_at(10.0).cameras[0].left_out_since, at(10.0));
    EXPECT_EQ(leave_one_out_at(11.0).cameras[0].left_out_since, at(10.0)) << "at least once a second";
    const LastUsed later = leave_one_out_at(12.5);
    EXPECT_EQ(later.cameras[0].left_out, at(12.5));
    EXPECT_EQ(later.cameras[0].left_out_since, at(12.5)) << "for a second and a half there was time for all";
    pipeline.finish();
}

TEST_F(CameraProblemsTest, have_nothing_of_a_camera_that_nobody_wants) {
    view_.now = *view_.used.cameras[0].frame + kSecond;
    EXPECT_NE(reported(ProblemCode::camera_silent, "camera"), std::nullopt);
    view_.cameras.clear();
    EXPECT_EQ(reported(ProblemCode::camera_silent), std::nullopt);
    EXPECT_EQ(reported(ProblemCode::depth_stopped), std::nullopt);
}

TEST_F(CameraProblemsTest, have_a_camera_beside_a_bus_that_fell_silent) {
    play_changed([](Scene& scene) { scene.rig.cameras.front().intrinsics.width = 17; });
    ScriptedBus bus;
    bus.heartbeat(0.0, node_of(scene_, kLeft));
    say(bus.frames().front().frame);
    view_.now = monotonic_now() + kSecond;
    view_.cameras[0].newest = view_.now;
    EXPECT_THAT(reported(ProblemCode::camera_bus_silent, "camera"), Optional(key_is("joints_missing")));
    EXPECT_EQ(reported(ProblemCode::camera_size), std::nullopt);
    view_.now = monotonic_now();
    view_.cameras[0].newest = view_.now;
    EXPECT_EQ(reported(ProblemCode::camera_bus_silent), std::nullopt);
    EXPECT_NE(reported(ProblemCode::camera_size), std::nullopt);
}

TEST_F(CameraProblemsTest, have_a_camera_without_a_time_until_three_exchanges_of_the_other_host_agree) {
    view_.is_listen_only = true;
    const auto is_untimed = Optional(
        AllOf(is_problem(ProblemCode::camera_untimed, "camera", "SYNC"), what_has("three FOLLOW_UPs")));
    for (std::uint8_t sequence = 1; sequence <= 3; ++sequence) {
        EXPECT_THAT(reported(ProblemCode::camera_untimed), is_untimed);
        const HostTime heard = say_sync(sequence);
        say(wire::encode(wire::FollowUp{sequence, static_cast<std::uint64_t>(heard.ns / 1'000) + 900'000'000},
                         wire::kHostId));
        view_.now = heard;
        view_.cameras[0].newest = view_.used.cameras[0].frame = heard;
    }
    EXPECT_EQ(reported(ProblemCode::camera_untimed), std::nullopt);
    view_.now = view_.now + 6 * kSecond;
    view_.cameras[0].newest = view_.now;
    EXPECT_THAT(reported(ProblemCode::camera_untimed), is_untimed) << "it is silent again";
}

}  // namespace
}  // namespace octoskin::test
