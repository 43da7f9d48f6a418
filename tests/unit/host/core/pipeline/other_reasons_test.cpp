// Every reason to reject a frame, a joint sample or a depth frame, provoked once beside a good stream.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <set>
#include <string>

#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "tests/support/wire/frame_oracle.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

using Change = std::function<void(Scene&)>;

template <class Reason>
struct Case {
    Reason reason;
    Change provoke;
    Change prepare = {};  ///< for both runs
};
template <class Reason>
std::string name_of_case(const testing::TestParamInfo<Case<Reason>>& given) {
    return names_of(Reason{})[static_cast<std::size_t>(given.param.reason)];
}
template <class Reason>
void PrintTo(const Case<Reason>& given, std::ostream* out) {
    *out << names_of(Reason{})[static_cast<std::size_t>(given.reason)];
}
template <class Reason>
void expect_one_each(const std::vector<Case<Reason>>& cases, std::set<Reason> elsewhere) {
    for (const Case<Reason>& given : cases) {
        EXPECT_TRUE(elsewhere.insert(given.reason).second);
    }
    EXPECT_EQ(elsewhere.size(), names_of(Reason{}).size());
}

/// Both runs; one more in, one more rejected for this reason, everything else as before.
template <class Reason, class CountersOf>
void expect_one_more(const Case<Reason>& given, const CountersOf& counters_of) {
    Scene good = good_scene();
    if (given.prepare) {
        given.prepare(good);
    }
    Scene bad = good;
    given.provoke(bad);
    const RunResult expected = run(good);
    const RunResult result = run(bad);
    const InputCounters<Reason>& before = counters_of(expected.inputs);
    const InputCounters<Reason>& after = counters_of(result.inputs);
    EXPECT_EQ(after.rejected(given.reason), before.rejected(given.reason) + 1) << result.inputs_text;
    EXPECT_EQ(after.rejected(), before.rejected() + 1) << result.inputs_text;
    EXPECT_GT(after.used(), 0U);
    EXPECT_TRUE(result.has_equal_maps(expected)) << result.inputs_text;
}

// Frames.

wire::CanFrame good_frame() {
    return wire::encode(wire::Range{good_reading(kSpare)}, kLeft);
}
/// A valid frame of a message with some of its bits set otherwise, signed again.
wire::CanFrame forged(const wire::Message& message, wire::NodeId node, unsigned start, unsigned bits,
                      std::uint64_t raw) {
    const wire::CanFrame frame = wire::encode(message, node);
    Payload payload = payload_of(frame);
    set_bits(payload, start, bits, raw);
    sign(frame.can_id, payload, checksum_len_of(frame.can_id));
    return frame_of(frame.can_id, frame.is_fd, payload);
}
Change frame(std::function<void(wire::CanFrame&)> change) {
    return [=](Scene& scene) {
        wire::CanFrame given = good_frame();
        change(given);
        scene.bus.send(4.0, given);
    };
}
Change message(const wire::Message& message, wire::NodeId node, double at_s = 4.0) {
    return [=](Scene& scene) { scene.bus.send(at_s, message, node); };
}

const std::vector<Case<FrameReason>>& frame_cases() {
    using R = FrameReason;
    static const std::vector<Case<FrameReason>> all = {
        {R::foreign_format, frame([](auto& f) { f.is_extended = true; })},
        {R::unknown_type, frame([](auto& f) { f.can_id = (30U << 6U) | kLeft; })},
        {R::wrong_length, frame([](auto& f) { f.payload_len = 7; })},
        {R::wrong_crc, frame([](auto& f) { f.data[3] ^= 0x10U; })},
        {R::wrong_version,
         [](Scene& s) { s.bus.send(4.0, forged(wire::Range{good_reading()}, kLeft, 0, 3, 2)); }},
        {R::nonzero_padding,  // the bit before RANGE_AUX's checksum
         [](Scene& s) { s.bus.send(4.0, forged(wire::RangeAux{}, kLeft, 47, 1, 1)); }},
        {R::invalid_field,  // heartbeat: reset cause 6
         [](Scene& s) { s.bus.send(4.0, forged(wire::Heartbeat{}, kLeft, 6, 3, 6)); }},
        {R::unknown_node, message(wire::Range{good_reading()}, 50)},
        {R::unknown_sensor, message(wire::RangeAux{.sensor = 9, .sequence = 0, .signal = {}}, kLeft)},
        {R::host_command, message(wire::Command{}, kLeft)},
        {R::sync_unmatched,
         message(wire::FollowUp{.sequence = 31, .host_time_us = 4'000'000}, wire::kHostId)},
        {R::sync_repeated,
         [](Scene& s) {
             s.bus.send(4.2, wire::SyncReport{4, s.bus.node_time(kLeft, 4.1)}, kLeft);
         }},
        {R::sync_contradicted,
         [](Scene& s) {
             s.bus.send(4.2, wire::SyncReport{4, s.bus.node_time(kLeft, 4.13)}, kLeft);
         }},
        {R::node_refused,
         [](Scene& s) {
             wire::Heartbeat other_board{};
             other_board.uid_crc = 1;
             other_board.node_hash_low = 2;
             s.bus.heartbeat(4.0, node_of(s, kRight));
             s.bus.send(4.05, other_board, kRight);
             s.bus.send(4.06, wire::NodeInfo{wire::InfoFault{}}, kRight);
         }},
        {R::not_joint_source, message(wire::JointState{wire::JointPair{}}, kLeft)},
        {R::joint_repeated,
         [](Scene& s) {
             const auto frames = s.bus.frames();
             for (const StampedFrame& entry : frames) {
                 if (entry.stamp == wall_at(3.5 + 0.0004)) {
                     s.bus.send(3.5006, entry.frame);
                 }
             }
         }},
        {R::joint_no_host_time, message(wire::JointState{wire::JointPair{}}, kJoints, 0.05)},
        {R::diagnostic_frame, message(wire::BlackBox{}, kLeft)},
        {R::mark_ignored, message(wire::Mark{wire::MarkKind::stop, 3'500'000}, wire::kHostId, 3.5)},
    };
    return all;
}

class FrameReasons : public testing::TestWithParam<Case<FrameReason>> {};
TEST_P(FrameReasons, are_counted_once_and_leave_the_maps_alone) {
    expect_one_more(GetParam(), std::mem_fn(&PipelineInputs::frames));
}
INSTANTIATE_TEST_SUITE_P(Each, FrameReasons, testing::ValuesIn(frame_cases()), name_of_case<FrameReason>);
TEST(FrameReasonsAll, have_a_case_each) {
    expect_one_each(frame_cases(), {});
}

// Joint samples. All come after the last measurement, which is what they may not touch.

/// The next sample of the stream.
Change joints(double sampled_s, double position_rad) {
    return [=](Scene& scene) { scene.bus.joints(sampled_s, kJoints, {&position_rad, 1}); };
}
wire::JointState part_of_nothing(std::int32_t urad) {
    return wire::JointPair{.index = 1, .sequence = 6, .position_urad = {urad, 0}};
}
wire::JointState last_part(const Scene& scene, double sampled_s) {
    return wire::JointLast{5, 0, wire::fd_residue(scene.bus.node_time(kJoints, sampled_s))};
}

const std::vector<Case<JointReason>>& joint_cases() {
    using R = JointReason;
    static const std::vector<Case<JointReason>> all = {
        {R::incomplete, message(part_of_nothing(0), kJoints, 9.2)},
        {R::contradictory, message(part_of_nothing(0), kJoints, 9.19),
         // Incomplete in both runs.
         message(part_of_nothing(1), kJoints, 9.2)},
        {R::clock_not_ready, joints(0.45, 0.0)},
        {R::clock_in_doubt, joints(9.5, 0.0),
         [](Scene& s) {
             s.bus.exchange(9.1, {});
             s.bus.send(9.104, wire::SyncReport{9, s.bus.node_time(kJoints, 9.15)}, kJoints);
         }},
        {R::clock_silent, joints(13.2, 0.0)},
        {R::too_old,
         [](Scene& s) {
             for (std::uint8_t index = 0; index < 3; ++index) {
                 s.bus.send(9.2, wire::JointState{wire::JointPair{index, 5, {}}}, kJoints);
             }
             s.bus.send(9.2, last_part(s, 9.149), kJoints);
         }},
        {R::out_of_limits, joints(9.2, 3.3)},
        {R::joint_jump, joints(9.05, 0.0)},  // 2.37 rad in 50 ms
        {R::out_of_order,
         [](Scene& s) {
             const double position = 0.0;
             s.bus.joints(9.2, kJoints, {&position, 1});
         },
         [](Scene& s) {
             const double position = 0.0;
             s.bus.joints(9.2, kJoints, {&position, 1});
         }},
        {R::wrong_count,
         [](Scene& s) {
             s.bus.joints(9.2, kJoints, std::array{0.0, 0.1});
         }},
    };
    return all;
}

class JointReasons : public testing::TestWithParam<Case<JointReason>> {};
TEST_P(JointReasons, are_counted_once_and_leave_the_maps_alone) {
    Case<JointReason> given = GetParam();
    given.prepare = [prepare = given.prepare](Scene& scene) {
        for (int k = 90; k < 135; ++k) {  // the bus itself is not silent
            scene.bus.heartbeat(0.1 * k, node_of(scene, kLeft));
        }
        if (prepare) {
            prepare(scene);
        }
    };
    expect_one_more(given, std::mem_fn(&PipelineInputs::joint_samples));
}
INSTANTIATE_TEST_SUITE_P(Each, JointReasons, testing::ValuesIn(joint_cases()), name_of_case<JointReason>);
TEST(JointReasonsAll, have_a_case_each) {
    // A source that is too quick has many rejected at once: can_intake_test. So has a second sender:
    // second_joint_sender_test.
    expect_one_each(joint_cases(),
                    {JointReason::queue_overflow, JointReason::too_frequent, JointReason::second_sender});
}
TEST(JointReasonsAll, drop_the_oldest_where_too_many_wait) {
    Scene crowded = good_scene();
    crowded.config.waiting_max.joint_samples = 5;
    const RunResult result = run(crowded);
    // 150 ms of 100 Hz wait: ten of them too many. None reaches a reading in time but those of the last
    // moment.
    EXPECT_GT(result.inputs.joint_samples.rejected(JointReason::queue_overflow), 500U);
    EXPECT_EQ(result.inputs.readings.used(), 0U);
    EXPECT_EQ(result.inputs.readings.rejected(ReadingReason::joints_missing), 10U);
}

// Depth frames.

Change depth(std::size_t before, DepthFrame given) {
    return [=](Scene& scene) {
        scene.depth.insert(scene.depth.begin() + static_cast<std::ptrdiff_t>(before), given);
    };
}
DepthFrame of_wrong_size() {
    DepthFrame given = flat_frame(4.05);
    given.width = 15;
    given.depth_mm.resize(15 * 12);
    return given;
}

const std::vector<Case<DepthReason>>& depth_cases() {
    using R = DepthReason;
    static const std::vector<Case<DepthReason>> all = {
        {R::wrong_size, depth(1, of_wrong_size())},
        {R::out_of_order, depth(1, flat_frame(4.0))},
        {R::ahead_of_time, depth(6, flat_frame(11.0))},
        {R::outside_marks, depth(0, flat_frame(3.45)),
         [](Scene& s) {
             s.config.begin = MapBegin::start_mark;
             s.bus.send(3.5, wire::Mark{wire::MarkKind::start, 3'500'000}, wire::kHostId);
         }},
        {R::joints_missing, depth(6, flat_frame(7.15))},
        {R::box_too_large, depth(6, flat_frame(4.6, 4400)),
         [](Scene& s) { s.mapping.depth_box_voxels_max = 200'000; }},
    };
    return all;
}

class DepthReasons : public testing::TestWithParam<Case<DepthReason>> {};
TEST_P(DepthReasons, are_counted_once_and_leave_the_maps_alone) {
    expect_one_more(
        GetParam(), [](const PipelineInputs& inputs) -> auto& { return inputs.depth_frames.front(); });
}
INSTANTIATE_TEST_SUITE_P(Each, DepthReasons, testing::ValuesIn(depth_cases()), name_of_case<DepthReason>);
TEST(DepthReasonsAll, have_a_case_each) {
    expect_one_each(depth_cases(), {DepthReason::no_camera, DepthReason::queue_overflow, DepthReason::late,
                                    DepthReason::outside_map, DepthReason::no_memory});
}
TEST(DepthReasonsAll, reject_every_frame_without_a_camera_in_the_rig) {
    Scene scene = good_scene();
    scene.rig.cameras.clear();
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.depth_frames.front().rejected(DepthReason::no_camera), 6U);
    EXPECT_EQ(result.fused_ot, result.proximity_ot);
}
TEST(DepthReasonsAll, reject_every_frame_of_a_camera_outside_the_octree) {
    Scene scene = good_scene();
    scene.rig.cameras.front().T_link_camera.translation().x() = 2000.0;
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.depth_frames.front().rejected(DepthReason::outside_map), 6U);
    EXPECT_EQ(result.fused_ot, result.proximity_ot);
}
TEST(DepthReasonsAll, refuse_the_newest_where_too_many_wait) {
    Scene scene = good_scene();
    scene.config.waiting_max.depth_frames = 2;
    const RunResult result = run(scene);
    // Ten a second, each waits 250 ms: no room at 4.2 and 4.5 s.
    EXPECT_EQ(result.inputs.depth_frames.front().rejected(DepthReason::queue_overflow), 2U);
    EXPECT_EQ(result.inputs.depth_frames.front().used(), 4U);
}
TEST(DepthReasonsAll, reject_a_frame_that_comes_after_the_map_has_gone_on) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
    }
    pipeline.on_depth(flat_frame(3.6));  // the last reading in the map was captured at 3.802
    pipeline.on_depth(flat_frame(4.0));
    pipeline.finish();
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::late), 1U);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 1U);
    EXPECT_TRUE(pipeline.is_balanced());
}

}  // namespace
}  // namespace octoskin::test
