#include "host/core/pipeline/replay.hpp"

#include <utility>

namespace octoskin {
namespace {

/// A depth source with its next frame prefetched.
class DepthFeed {
  public:
    DepthFeed(DepthSource* source, ReplayOutcome& outcome) : source_(source), outcome_(outcome) { fetch(); }

    void feed_until(HostTime now, Pipeline& pipeline) {
        while (next_ && next_->captured <= now) {  // ends with the source
            feed_one(pipeline);
        }
    }
    void feed_rest(Pipeline& pipeline) {
        while (next_) {
            feed_one(pipeline);
        }
    }

  private:
    void feed_one(Pipeline& pipeline) {
        pipeline.on_depth(*std::exchange(next_, std::nullopt));
        ++outcome_.progress.depth_frames;
        fetch();
    }
    void fetch() {
        if (source_ == nullptr) {
            return;
        }
        Result<std::optional<DepthFrame>, Error> frame = source_->next();
        if (frame) {
            next_ = std::move(frame).value();
            return;
        }
        outcome_.depth_error = frame.error();
        source_ = nullptr;
    }

    DepthSource* source_;
    ReplayOutcome& outcome_;
    std::optional<DepthFrame> next_;
};

std::optional<StampedFrame> next_frame(CanSource& can, ReplayOutcome& outcome) {
    Result<std::optional<StampedFrame>, Error> frame = can.next();
    if (frame) {
        return std::move(frame).value();
    }
    outcome.can_error = frame.error();
    return std::nullopt;
}

}  // namespace

ReplayOutcome replay(Pipeline& pipeline, CanSource& can, DepthSource* depth, const ReplayReport& report) {
    ReplayOutcome outcome;
    ReplayProgress& progress = outcome.progress;
    DepthFeed depth_feed(depth, outcome);
    while (const auto entry = next_frame(can, outcome)) {
        pipeline.on_can(entry->frame, entry->stamp);
        if (const auto now = pipeline.now()) {
            depth_feed.feed_until(*now, pipeline);
            progress.now = now;
            progress.begin = progress.begin ? progress.begin : pipeline.intake().host_clock().begun();
        }
        if (++progress.can_frames % kReplayReportEvery == 0 && report) {
            report(progress);
        }
    }
    pipeline.finish_can();
    depth_feed.feed_rest(pipeline);
    pipeline.finish();
    if (report) {
        report(progress);
    }
    return outcome;
}

}  // namespace octoskin
