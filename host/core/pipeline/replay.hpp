// Replays a recording through the pipeline: CAN frames in the order of the log, depth frames inserted by
// time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

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
    /// Sources that failed before their end; their inputs until then were used.
    std::optional<Error> can_error;
    std::vector<Error> depth_errors;
    [[nodiscard]] bool is_complete() const { return !can_error && depth_errors.empty(); }
};

/// Called after every `kReplayReportEvery` frames and at the end.
using ReplayReport = std::function<void(const ReplayProgress&)>;
inline constexpr std::uint64_t kReplayReportEvery = 1000;

/// The depth frames of a recording by the index of their camera in the rig; null, or missing at the end:
/// there are none of it.
using DepthSources = std::vector<DepthSource*>;

/// Feeds all sources into `pipeline` until they end, then finishes it. A depth frame is added once the host
/// time of the log has reached its capture time. The maps do not depend on which source is read first.
[[nodiscard]] ReplayOutcome replay(Pipeline& pipeline, CanSource& can, const DepthSources& depth,
                                   const ReplayReport& report = {});

}  // namespace octoskin
