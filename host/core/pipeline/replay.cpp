#include "host/core/pipeline/replay.hpp"

#include <utility>

namespace octoskin {
namespace {

/// The depth sources, each with its next frame prefetched.
class DepthFeed {
  public:
    DepthFeed(const DepthSources& sources, ReplayOutcome& outcome) : outcome_(outcome) {
        for (DepthSource* const source : sources) cameras_.push_back({source, std::nullopt});
        for (std::size_t camera = 0; camera < cameras_.size(); ++camera) fetch(camera);
    }

    void feed_until(HostTime now, Pipeline& pipeline) {
        for (auto next = earliest(); next && frame_of(*next)->captured <= now; next = earliest())
            feed(*next, pipeline);
    }
    void feed_rest(Pipeline& pipeline) {
        while (const auto next = earliest()) feed(*next, pipeline);
    }

  private:
    struct Camera {
        DepthSource* source;  ///< null: it has ended
        std::optional<DepthFrame> next;
    };
    [[nodiscard]] std::optional<DepthFrame>& frame_of(std::size_t camera) { return cameras_[camera].next; }
    /// The camera with the earliest next frame; empty if all sources have ended.
    [[nodiscard]] std::optional<std::size_t> earliest() {
        std::optional<std::size_t> earliest;
        for (std::size_t camera = 0; camera < cameras_.size(); ++camera) {
            if (!frame_of(camera)) continue;
            if (!earliest || frame_of(camera)->captured < frame_of(*earliest)->captured) earliest = camera;
        }
        return earliest;
    }
    void feed(std::size_t camera, Pipeline& pipeline) {
        pipeline.on_depth(*std::exchange(frame_of(camera), std::nullopt));
        ++outcome_.progress.depth_frames;
        fetch(camera);
    }
    void fetch(std::size_t camera) {
        DepthSource*& source = cameras_[camera].source;
        if (source == nullptr) return;
        Result<std::optional<DepthFrame>, Error> frame = source->next();
        if (!frame) {
            outcome_.depth_errors.push_back(frame.error());
            source = nullptr;
            return;
        }
        frame_of(camera) = std::move(frame).value();
        if (frame_of(camera)) frame_of(camera)->camera = static_cast<std::uint8_t>(camera);
    }

    std::vector<Camera> cameras_;
    ReplayOutcome& outcome_;
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

ReplayOutcome replay(Pipeline& pipeline, CanSource& can, const DepthSources& depth,
                     const ReplayReport& report) {
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
