// Plays a recording through the pipeline: frames in the order of the log, depth frames where they belong
// among them.
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

/// How far a replay has come.
struct ReplayProgress {
    std::uint64_t can_frames = 0;  ///< of a replay in a daemon's order: commits
    std::uint64_t depth_frames = 0;
    std::optional<HostTime> begin;  ///< of the recording: its first frame, once the host's clock is known
    std::optional<HostTime> now;
};

struct ReplayOutcome {
    ReplayProgress progress;
    /// A source that failed before its end; what it gave until then was used.
    std::optional<CanSourceError> can_error;
    std::optional<DepthSourceError> depth_error;
    [[nodiscard]] bool is_complete() const { return !can_error && !depth_error; }
};

/// Called after every `kReplayReportEvery` frames and at the end.
using ReplayReport = std::function<void(const ReplayProgress&)>;
inline constexpr std::uint64_t kReplayReportEvery = 1000;

/// Feeds both sources into `pipeline` until they end, then finishes it. `depth`: null if there is none. A
/// depth frame is given in once the host's clock, as the log tells it, has reached its capture time.
[[nodiscard]] ReplayOutcome replay(Pipeline& pipeline, CanSource& can, DepthSource* depth,
                                   const ReplayReport& report = {});

}  // namespace octoskin
