// A second sender of joint states under the rig's joint node, in a recording of the whole simulated rig: real
// node cores, one virtual clock. It knows the protocol: right checksums, right numbers, right times.
//
// The oracle is the same bus without it. No reading may be placed elsewhere than there; what is lost is lost
// to joints_missing, while the second sender is heard and for a second after, and nothing else is.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/wire/codec.hpp"
#include "common/wire/joint_frames.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/orderlog/order_line.hpp"
#include "host/io/rig/host_rig_reader.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "tests/support/experiment_log/experiment_log.hpp"

namespace octoskin::test {
namespace {

constexpr double kPeriodS = 0.01;

/// The experiment's arm, 2 s at rest and then one revolution in 10 s, with its 34 sensors and no camera.
struct Recorded {
    HostSetup setup;
    std::vector<StampedFrame> frames;
};
const Recorded& recorded() {
    static const Recorded one = [] {
        rig::Rig rig = rig::read_rig(OCTOSKIN_SOURCE_DIR "/hw/rigs/experiment.yaml").value();
        rig.cameras.clear();
        return Recorded{make_host_setup(rig).value(), experiment_log(rig, 5)};
    }();
    return one;
}

/// A whole sample of the joint node as it is in the recording: where its last frame is, and what it says.
struct Sample {
    std::size_t first = 0;
    std::size_t last = 0;
    std::uint8_t sequence = 0;
    std::array<std::int32_t, wire::kJointsPerSample> position_urad{};
    std::uint32_t sampled_us = 0;
};
std::vector<Sample> samples_of(const std::vector<StampedFrame>& frames, wire::NodeId joint_node) {
    std::vector<Sample> samples;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const auto decoded = wire::decode(frames[i].frame);
        const auto* const state = decoded ? std::get_if<wire::JointState>(&decoded->message) : nullptr;
        if (state == nullptr || decoded->node_id != joint_node) continue;
        if (const auto* pair = std::get_if<wire::JointPair>(state)) {
            if (pair->index == 0) samples.push_back({.first = i, .last = i, .sequence = pair->sequence});
            std::ranges::copy(pair->position_urad, samples.back().position_urad.begin() + 2 * pair->index);
        } else {
            const auto& end = std::get<wire::JointLast>(*state);
            samples.back().position_urad[6] = end.position_urad;
            samples.back().sampled_us = end.sampled.value_us;
            samples.back().last = i;
        }
    }
    return samples;
}

struct Attack {
    std::string name;
    double hz = 0.0;                 ///< forged samples a second
    double posture_rad = 0.6;        ///< what it says of the first joint, beside the truth
    int number_ahead = 0;            ///< of the number that the joint node sends next
    double before_s = 0.003;         ///< it comes before the node's own sample, at a time of 4 ms before
    std::optional<int> one_frame{};  ///< of the forged sample that frame alone
    bool is_within = false;          ///< it comes between the frames of the node's own sample
    bool repeats_time = false;       ///< its time is the node's own, to the microsecond
};

struct Forged {
    std::vector<StampedFrame> frames;
    WallTime begin;
    WallTime end;
};

constexpr double kAttackBeginS = 5.0;
constexpr double kAttackEndS = 9.0;

Forged forge(const Attack& attack) {
    const std::vector<StampedFrame>& honest = recorded().frames;
    const wire::NodeId node = recorded().setup.rig.joint_sources.at(0).node_id;
    Forged forged{honest, {}, {}};
    const WallTime start = honest.front().stamp;
    double due_s = kAttackBeginS;
    for (const Sample& sample : samples_of(honest, node)) {
        const double at_s = 1e-9 * static_cast<double>(honest[sample.first].stamp.ns - start.ns);
        if (at_s < due_s || at_s > kAttackEndS) continue;
        due_s += 1.0 / attack.hz;
        auto position = sample.position_urad;
        for (const std::size_t joint : {0U, 2U, 4U, 6U})  // one in each frame
            position.at(joint) += static_cast<std::int32_t>(std::lround(1e6 * attack.posture_rad));
        const double dated_before_s = attack.repeats_time ? 0.0 : attack.before_s + 0.004;
        const auto dated_us = static_cast<std::uint32_t>(sample.sampled_us + wire::kFdTimeSpanUs -
                                                         static_cast<std::uint32_t>(1e6 * dated_before_s));
        const auto number = static_cast<std::uint8_t>((sample.sequence + attack.number_ahead) % 8);
        const auto frames =
            wire::joint_frames(node, number, position, {dated_us % wire::kFdTimeSpanUs, wire::kFdTimeSpanUs});
        WallTime stamp = attack.is_within
                             ? WallTime{honest[sample.first].stamp.ns + 1'000}
                             : WallTime{honest[sample.first].stamp.ns - std::llround(1e9 * attack.before_s)};
        for (std::size_t i = 0; i < frames.size(); ++i) {
            if (attack.one_frame && *attack.one_frame != static_cast<int>(i)) continue;
            forged.frames.push_back({stamp, frames.at(i)});
            stamp.ns += 120'000;
        }
        if (forged.begin.ns == 0) forged.begin = stamp;
        forged.end = stamp;
    }
    std::ranges::stable_sort(forged.frames, {}, &StampedFrame::stamp);
    return forged;
}

/// Every reading that was placed, by where and when it was measured.
class Placed final : public CommitListener {
  public:
    using Key = std::pair<BeamSource, std::int64_t>;
    void on_joints(const JointMeasurement& joints) override { commits.emplace_back(joints); }
    void on_reading(const RangeMeasurement& measurement, const Beam& beam,
                    std::span<const VoxelUpdate>) override {
        beams.emplace(Key{beam.source, beam.captured.ns}, beam);
        commits.emplace_back(measurement);
    }
    void on_depth(const DepthFrame&, const Evidence&) override {}

    std::map<Key, Beam> beams;
    std::vector<Commit> commits;
};

struct Played {
    Placed placed;
    PipelineInputs inputs;
    std::uint64_t contradictions = 0;
    std::optional<WallTime> named;  ///< when two senders, or a jump, were first told of
    std::optional<WallTime> named_last;
    std::optional<WallTime>
        refused;  ///< when the joint node was first told of as one whose word does not count
    std::string map;
};

std::uint64_t reported_of(const Pipeline& pipeline) {
    const auto& joints = pipeline.inputs().joint_samples;
    return pipeline.intake().joint_senders(0).contradictions() + joints.rejected(JointReason::second_sender) +
           joints.rejected(JointReason::joint_jump);
}

Played play(const std::vector<StampedFrame>& frames, Release release) {
    const HostSetup& setup = recorded().setup;
    PipelineConfig config;
    config.release = release;
    config.maps = {MapFeed::both};
    Pipeline pipeline = Pipeline::build(setup.rig, setup.robot, robust_mapping(), config).value();
    Played played;
    pipeline.set_listener(&played.placed);
    std::uint64_t reported = 0;
    for (const StampedFrame& entry : frames) {
        pipeline.on_can(entry.frame, entry.stamp);
        const CanIntake& intake = pipeline.intake();
        if (!played.refused && is_refused_for_joints(intake.nodes().verdict(
                                   setup.rig.joint_sources.at(0).node_id, intake.now())))
            played.refused = entry.stamp;
        if (reported_of(pipeline) == reported) continue;
        reported = reported_of(pipeline);
        if (!played.named) played.named = entry.stamp;
        played.named_last = entry.stamp;
    }
    pipeline.finish();
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    played.inputs = pipeline.inputs();
    played.contradictions = pipeline.intake().joint_senders(0).contradictions();
    played.map = encode_ot(pipeline.map());
    return played;
}

const Played& clean(Release release) {
    static const Played live = play(recorded().frames, Release::once_placed);
    static const Played replayed = play(recorded().frames, Release::by_capture_time);
    return release == Release::once_placed ? live : replayed;
}

/// The largest distance of an origin, and of a point 1 m along the beam.
double apart_m(const Beam& a, const Beam& b) {
    const Eigen::Vector3d end_a = a.p_map_sensor + a.direction_map;
    const Eigen::Vector3d end_b = b.p_map_sensor + b.direction_map;
    return std::max((a.p_map_sensor - b.p_map_sensor).norm(), (end_a - end_b).norm());
}

/// The map of the clean run's commits, without the readings that the other run did not place.
std::string map_without(const Placed& all, const Placed& kept) {
    const HostSetup& setup = recorded().setup;
    PipelineConfig config;
    config.maps = {MapFeed::both};
    Pipeline pipeline = Pipeline::build(setup.rig, setup.robot, robust_mapping(), config).value();
    for (const Commit& commit : all.commits) {
        if (const auto* joints = std::get_if<JointMeasurement>(&commit)) {
            EXPECT_TRUE(pipeline.builder().add(*joints));
        } else if (const auto* reading = std::get_if<RangeMeasurement>(&commit)) {
            if (kept.beams.contains({reading->source, reading->captured.ns})) {
                EXPECT_TRUE(pipeline.builder().integrate(*reading));
            }
        }
    }
    return encode_ot(pipeline.map());
}

/// The map of what was committed, by way of the text that a recording has of it.
std::string map_of_order(const std::vector<Commit>& commits) {
    const HostSetup& setup = recorded().setup;
    const orderlog::CommitForm form{.joints = setup.rig.joint_counts()};
    PipelineConfig config;
    config.maps = {MapFeed::both};
    Pipeline pipeline = Pipeline::build(setup.rig, setup.robot, robust_mapping(), config).value();
    for (const Commit& commit : commits) {
        std::string line = orderlog::format_commit(commit, form);
        line.pop_back();
        const auto read = orderlog::parse_commit(line, form);
        EXPECT_TRUE(read) << line;
        if (const auto* joints = std::get_if<JointMeasurement>(&*read)) {
            EXPECT_TRUE(pipeline.builder().add(*joints));
        } else {
            EXPECT_TRUE(pipeline.builder().integrate(std::get<RangeMeasurement>(*read)));
        }
    }
    return encode_ot(pipeline.map());
}

double seconds_between(WallTime from, WallTime to) {
    return 1e-9 * static_cast<double>(to.ns - from.ns);
}

/// For what is known before a pose is: the rest is joints_missing where there is none.
std::uint64_t rejected_without_pose(const InputCounters<ReadingReason>& readings) {
    std::uint64_t rejected = readings.rejected();
    for (const ReadingReason reason :
         {ReadingReason::joints_missing, ReadingReason::self_hit, ReadingReason::beam_not_valid,
          ReadingReason::outside_map, ReadingReason::cone_too_large})
        rejected -= readings.rejected(reason);
    return rejected;
}

/// Of the readings that the clean run placed: none elsewhere, and none lost but while two were heard.
void expect_no_wrong_place(const Played& played, const Played& expected, const Forged& forged,
                           double apart_max_m) {
    std::size_t lost = 0;
    double apart = 0.0;
    for (const auto& [key, beam] : played.placed.beams) {
        const auto same = expected.placed.beams.find(key);
        ASSERT_NE(same, expected.placed.beams.end()) << "a reading that is not there without the attack";
        apart = std::max(apart, apart_m(beam, same->second));
    }
    EXPECT_LE(apart, apart_max_m);
    for (const auto& [key, beam] : expected.placed.beams) lost += played.placed.beams.contains(key) ? 0U : 1U;
    const auto& before = expected.inputs.readings;
    const auto& after = played.inputs.readings;
    EXPECT_EQ(after.used() + lost, before.used());
    EXPECT_GE(after.rejected(ReadingReason::joints_missing),
              before.rejected(ReadingReason::joints_missing) + lost);
    EXPECT_EQ(rejected_without_pose(after), rejected_without_pose(before))
        << "what has nothing to do with joints is as it was";
    const double held_s = seconds_between(forged.begin, forged.end) + 1.0 + 5 * kPeriodS;
    const double readings_hz = static_cast<double>(before.used()) / 10.0;
    EXPECT_LE(static_cast<double>(lost), 1.15 * held_s * readings_hz);
}

std::vector<Attack> attacks_of_whole_samples() {
    std::vector<Attack> all;
    for (const double hz : {1.0, 2.0, 5.0, 10.0, 50.0, 100.0}) {
        const std::string rate = std::to_string(static_cast<int>(hz)) + "/s";
        all.push_back({.name = "another posture, " + rate, .hz = hz});
        all.push_back({.name = "a posture close by, " + rate, .hz = hz, .posture_rad = 0.02});
        all.push_back({.name = "the same posture, " + rate, .hz = hz, .posture_rad = 0.0});
    }
    for (int ahead = 1; ahead < 8; ++ahead)
        all.push_back({.name = "a number " + std::to_string(ahead) + " ahead",
                       .hz = 2.0,
                       .posture_rad = 0.02,
                       .number_ahead = ahead});
    for (const double before_s : {0.0002, 0.001, 0.0055})
        all.push_back({.name = "a moment before it", .hz = 2.0, .posture_rad = 0.02, .before_s = before_s});
    return all;
}

TEST(SecondJointSender, under_the_joint_node_moves_no_voxel_and_is_named_within_a_second) {
    for (const Release release : {Release::by_capture_time, Release::once_placed}) {
        const Played& expected = clean(release);
        ASSERT_GT(expected.placed.beams.size(), 5'000U);
        EXPECT_FALSE(expected.named) << "a sound bus";
        for (const Attack& attack : attacks_of_whole_samples()) {
            SCOPED_TRACE(attack.name + (release == Release::once_placed ? ", live" : ", replayed"));
            const Forged forged = forge(attack);
            const Played played = play(forged.frames, release);
            expect_no_wrong_place(played, expected, forged, 0.0);
            ASSERT_TRUE(played.named);
            EXPECT_LE(seconds_between(forged.begin, *played.named), 0.1);
            EXPECT_LE(seconds_between(forged.end, *played.named_last), 1.1);
            if (release == Release::by_capture_time) {
                EXPECT_TRUE(played.map == map_without(expected.placed, played.placed));
            }
            EXPECT_TRUE(played.map == map_of_order(played.placed.commits)) << "what a recording gives again";
        }
    }
}

// A frame alone voids the node's own sample: the poses are interpolated across twice the period then.
wire::Heartbeat own_heartbeat() {
    for (const StampedFrame& entry : recorded().frames) {
        const auto decoded = wire::decode(entry.frame);
        const auto* reported = decoded ? std::get_if<wire::Heartbeat>(&decoded->message) : nullptr;
        if (reported != nullptr && reported->state == wire::NodeState::ranging &&
            decoded->node_id == recorded().setup.rig.joint_sources.at(0).node_id)
            return *reported;
    }
    return {.state = wire::NodeState::ranging};
}

/// Each sample of the joint node itself comes between two heartbeats: by the first its word does not count,
/// by the second it does. After every second one comes another, with the same number and 2 ms later.
Forged forge_with_refused_samples() {
    const std::vector<StampedFrame>& honest = recorded().frames;
    const wire::NodeId node = recorded().setup.rig.joint_sources.at(0).node_id;
    Forged forged{honest, {}, {}};
    unsigned count = 0;
    for (const Sample& sample : samples_of(honest, node)) {
        const WallTime first = honest[sample.first].stamp;
        const WallTime last = honest[sample.last].stamp;
        const double at_s = seconds_between(honest.front().stamp, first);
        if (at_s < kAttackBeginS || at_s > kAttackEndS) continue;
        if (forged.begin.ns == 0) forged.begin = first;
        forged.end = last;
        wire::Heartbeat reported = own_heartbeat();
        reported.is_time_suspect = true;
        forged.frames.push_back({{first.ns - 1'000}, wire::encode(reported, node)});
        reported.is_time_suspect = false;
        forged.frames.push_back({{last.ns + 1'000}, wire::encode(reported, node)});
        if (++count % 2 != 0) continue;
        auto position = sample.position_urad;
        position[0] += static_cast<std::int32_t>(std::lround(1e6 * 0.3 * (at_s - kAttackBeginS)));
        const wire::TimeResidue sampled{(sample.sampled_us + 2'000U) % wire::kFdTimeSpanUs,
                                        wire::kFdTimeSpanUs};
        std::int64_t stamp_ns = last.ns + 2'000'000;
        for (const wire::CanFrame& frame : wire::joint_frames(node, sample.sequence, position, sampled))
            forged.frames.push_back({{stamp_ns += 1'000}, frame});
    }
    std::ranges::stable_sort(forged.frames, {}, &StampedFrame::stamp);
    return forged;
}

TEST(SecondJointSender, that_has_the_node_s_own_samples_refused_moves_no_voxel_and_the_node_is_named) {
    const Forged forged = forge_with_refused_samples();
    for (const Release release : {Release::by_capture_time, Release::once_placed}) {
        const Played played = play(forged.frames, release);
        expect_no_wrong_place(played, clean(release), forged, 0.0);
        EXPECT_FALSE(clean(release).refused);
        ASSERT_TRUE(played.refused);
        EXPECT_LE(seconds_between(forged.begin, *played.refused), 0.1);
    }
}

TEST(SecondJointSender, whose_single_frames_come_among_the_nodes_own_mixes_no_sample_and_is_named) {
    const Played& expected = clean(Release::once_placed);
    for (const bool is_within : {false, true}) {
        for (int frame = 0; frame < 4; ++frame) {
            for (const double hz : {2.0, 10.0, 50.0}) {
                SCOPED_TRACE(std::to_string(frame) + (is_within ? " within, " : " before, ") +
                             std::to_string(hz));
                const Forged forged = forge(
                    {.name = "", .hz = hz, .one_frame = frame, .is_within = is_within, .repeats_time = true});
                const Played played = play(forged.frames, Release::once_placed);
                expect_no_wrong_place(played, expected, forged, 1e-4);
                ASSERT_TRUE(played.named);
                EXPECT_LE(seconds_between(forged.begin, *played.named), 1.0);
            }
        }
    }
}

}  // namespace
}  // namespace octoskin::test
