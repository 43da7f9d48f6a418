// Playback of a daemon's recording in the daemon's own order.
#pragma once

#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/core/pipeline/ordered_replay.hpp"

namespace octoskin {

struct OrderedPlayback {
    OrderedOutcome outcome;
    bool has_daemons_mapping = false;  ///< voxels that had no room here had none in the daemon either
    std::vector<CounterTable> inputs = {};
    bool is_unlike_daemons = false;  ///< the map differs from the daemon's, and nothing given explains it
    /// Whether the map equals the daemon's, and if not, why.
    std::vector<std::string> notes = {};
    std::vector<std::string> warnings = {};
};

/// Whether the recording has an order.log and the request does not ask for another order.
[[nodiscard]] bool is_played_in_order(const PlaybackRequest& request);

/// Plays order.log into the maps of `pipeline`, which must be unused. It begins with first.snapshot, or with
/// first.ot if there is no snapshot or the given mapping is not the daemon's.
/// `depth`: of each camera of `rig`; null if there is none. `begin`: of the recording, if it is known.
/// Errors: an order.log of another version, with another number of joints or other cameras; an initial file
/// that is not the recording's, is damaged, has another resolution than the mapping, or needs more memory.
[[nodiscard]] Result<OrderedPlayback, AppError> play_in_order(const PlaybackRequest& request,
                                                              const rig::Rig& rig, Pipeline& pipeline,
                                                              const DepthSources& depth,
                                                              std::optional<HostTime> begin,
                                                              const ReplayReport& report);

}  // namespace octoskin
