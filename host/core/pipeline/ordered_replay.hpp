// Plays what a daemon recorded in the very order in which it put that into its map.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/core/account/account.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/commit.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "host/core/pipeline/replay.hpp"

namespace octoskin {

/// Why no further commit will come: what, where and what to do, for a person.
struct CommitSourceError {
    std::string what;
};

class CommitSource {
  public:
    virtual ~CommitSource() = default;
    /// The next one in the daemon's order; empty at the end, and then for ever.
    [[nodiscard]] virtual Result<std::optional<Commit>, CommitSourceError> next() = 0;
};

struct OrderedOutcome {
    std::uint64_t commits = 0;
    Account<ReadingReason> readings;
    Account<JointReason> joint_samples;
    Account<DepthReason> depth_frames;
    std::uint64_t depth_missing = 0;  ///< committed by the daemon, and not recorded
    std::optional<HostTime> begin;    ///< of the recording
    std::optional<HostTime> now;      ///< of the newest commit
    /// A source that failed before its end; what it gave until then was used.
    std::optional<CommitSourceError> order_error;
    std::optional<DepthSourceError> depth_error;

    /// Everything went into the maps that went into the daemon's.
    [[nodiscard]] bool took_all() const noexcept {
        return !order_error && !depth_error && depth_missing == 0 &&
               readings.rejected() + joint_samples.rejected() + depth_frames.rejected() == 0;
    }
};

/// Gives every commit to `builder`, in order, until the source ends. `depth`: the frames that depth commits
/// speak of by their place, from 0; null if there are none. `begin`: of the recording, where something else
/// tells it; else that is the first reading or depth frame: the joint samples before may be of long before.
/// With the rig, robot, mapping and first map of the recording the maps are the daemon's own, bit for bit.
[[nodiscard]] OrderedOutcome replay_in_order(MapBuilder& builder, CommitSource& order, DepthSource* depth,
                                             const ReplayReport& report = {},
                                             std::optional<HostTime> begin = {});

}  // namespace octoskin
