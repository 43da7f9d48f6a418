// Replays a recording through the pipeline: CAN frames in the order of the log, depth frames inserted by
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "host/core/pipeline/pipeline.hpp"

namespace octoskin {

/// Progress of a replay.
struct ReplayProgress {
    std::uint64_t can_frames = 0;  ///< in a replay in a daemon's order: commits
    std::uint64_t depth_frames = 0;
    std::optional<HostTime> begin;  ///< first frame of the recording, once the host's clock is known
    std::optional<HostTime> now;
};

struct ReplayOutcome {
    ReplayProgress progress;
    /// A source that failed before its end; its inputs until then were used.
    std::optional<Error> can_error;
    std::optional<Error> depth_error;
    [[nodiscard]] bool is_complete() const { return !can_error && !depth_error; }
};

/// Called after every `kReplayReportEvery` frames and at the end.
using ReplayReport = std::function<void(const ReplayProgress&)>;
inline constexpr std::uint64_t kReplayReportEvery = 1000;

/// Feeds both sources into `pipeline` until they end, then finishes it. `depth`: null if there is none. A
/// depth frame is added once the host time of the log has reached its capture time.
[[nodiscard]] ReplayOutcome replay(Pipeline& pipeline, CanSource& can, DepthSource* depth,
                                   const ReplayReport& report = {});

}  // namespace octoskin
