// Replays a daemon's recording in the order in which the daemon applied its inputs to the map.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/counters/input_counters.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/commit.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "host/core/pipeline/replay.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

class CommitSource {
  public:
    virtual ~CommitSource() = default;
    /// The next commit in the daemon's order; empty at the end and in every later call.
    [[nodiscard]] virtual Result<std::optional<Commit>, Error> next() = 0;
};

struct OrderedOutcome {
    std::uint64_t commits = 0;
    InputCounters<ReadingReason> readings;
    InputCounters<JointReason> joint_samples;
    InputCounters<DepthReason> depth_frames;
    std::uint64_t depth_missing = 0;  ///< committed by the daemon, but not recorded
    std::optional<HostTime> begin;    ///< of the recording
    std::optional<HostTime> now;      ///< of the newest commit
    /// Sources that failed before their end; their inputs until then were used.
    std::optional<Error> order_error;
    std::vector<Error> depth_errors;

    /// True if everything that went into the daemon's maps went into these.
    [[nodiscard]] bool took_all() const noexcept {
        return !order_error && depth_errors.empty() && depth_missing == 0 &&
               readings.rejected() + joint_samples.rejected() + depth_frames.rejected() == 0;
    }
};

/// Applies every commit to `builder`, in order, until the source ends. `depth`: the frames to which depth
/// commits refer by index, from 0. `begin`: start of the recording, if known from
/// elsewhere; otherwise the first reading or depth frame, because the joint samples before it may be much
/// older. With the rig, robot, mapping and first map of the recording, the maps are equal to the daemon's bit
/// for bit.
[[nodiscard]] OrderedOutcome replay_in_order(MapBuilder& builder, CommitSource& order,
                                             const DepthSources& depth, const ReplayReport& report = {},
                                             std::optional<HostTime> begin = {});

}  // namespace octoskin
