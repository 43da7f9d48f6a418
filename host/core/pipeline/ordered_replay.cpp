#include "host/core/pipeline/ordered_replay.hpp"

#include <utility>

namespace octoskin {
namespace {

/// A camera's depth frames requested by index, in ascending order.
class DepthByIndex {
  public:
    DepthByIndex(DepthSource* source, OrderedOutcome& outcome) : source_(source), outcome_(outcome) {}

    std::optional<DepthFrame> at(std::uint64_t index) {
        std::optional<DepthFrame> frame;
        while (source_ != nullptr && next_ <= index) {  // ends with the source
            auto read = source_->next();
            if (!read) outcome_.depth_errors.push_back(read.error());
            frame = read ? std::move(read).value() : std::nullopt;
            if (!frame) source_ = nullptr;
            ++next_;
        }
        return frame;
    }

  private:
    DepthSource* source_;
    OrderedOutcome& outcome_;
    std::uint64_t next_ = 0;
};

class Committer {
  public:
    Committer(MapBuilder& builder, const DepthSources& depth, OrderedOutcome& outcome)
        : builder_(builder), outcome_(outcome) {
        for (DepthSource* const source : depth) depth_.emplace_back(source, outcome);
    }

    std::optional<HostTime> operator()(const WaitCommit& passed) {
        builder_.wait(passed.seconds);
        return std::nullopt;
    }
    std::optional<HostTime> operator()(const JointMeasurement& joints) {
        outcome_.joint_samples.now_at(joints.sampled.ns);
        outcome_.joint_samples.count_in();
        outcome_.joint_samples.settle(builder_.add(joints));
        return joints.sampled;
    }
    std::optional<HostTime> operator()(const RangeMeasurement& reading) {
        const bool is_of_rig = builder_.has(reading.source);
        outcome_.readings.now_at(reading.captured.ns);
        outcome_.readings.count_in();
        outcome_.readings.settle(is_of_rig ? builder_.integrate(reading)
                                           : unexpected(ReadingReason::unknown_sensor));
        return reading.captured;
    }
    std::optional<HostTime> operator()(const DepthCommit& commit) {
        const bool is_recorded = commit.index && commit.camera < depth_.size();
        auto frame = is_recorded ? depth_[commit.camera].at(*commit.index) : std::nullopt;
        if (frame) {
            frame->camera = commit.camera;
            frame->captured = commit.captured;  // recorded depth frames have whole microseconds
            outcome_.depth_frames.now_at(commit.captured.ns);
            outcome_.depth_frames.count_in();
            outcome_.depth_frames.settle(builder_.integrate(std::move(*frame)));
        } else {
            ++outcome_.depth_missing;
        }
        return commit.captured;
    }

  private:
    MapBuilder& builder_;
    std::vector<DepthByIndex> depth_;  ///< by camera
    OrderedOutcome& outcome_;
};

}  // namespace

OrderedOutcome replay_in_order(MapBuilder& builder, CommitSource& order, const DepthSources& depth,
                               const ReplayReport& report, std::optional<HostTime> begin) {
    OrderedOutcome outcome;
    outcome.begin = begin;
    Committer committer(builder, depth, outcome);
    builder.accept_contradicting();
    const auto tell = [&] {
        if (report) report({outcome.commits, outcome.depth_frames.in(), outcome.begin, outcome.now});
    };
    while (true) {  // ends with the source
        auto commit = order.next();
        if (!commit) outcome.order_error = commit.error();
        if (!commit || !commit->has_value()) break;
        const auto time = std::visit(committer, **commit);
        if (time) outcome.now = time;
        if (!outcome.begin && time && !std::holds_alternative<JointMeasurement>(**commit))
            outcome.begin = time;
        if (++outcome.commits % kReplayReportEvery == 0) tell();
    }
    tell();
    return outcome;
}

}  // namespace octoskin
