// A recording that the daemon made, played in the daemon's own order.
#pragma once

#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/core/pipeline/ordered_replay.hpp"

namespace octoskin {

struct OrderedPlayback {
    OrderedOutcome outcome;
    bool has_daemons_mapping = false;  ///< what had no room here had none in the daemon
    std::vector<AccountTable> accounts = {};
    bool is_unlike_daemons = false;  ///< the map is not the daemon's own, and nothing given explains that
    /// Whether the map is the daemon's own, and if not, why.
    std::vector<std::string> notes = {};
    std::vector<std::string> warnings = {};
};

/// Whether the recording has an order.log and the request asks for nothing else.
[[nodiscard]] bool is_played_in_order(const PlaybackRequest& request);

/// Plays order.log into the maps of `pipeline`, which has been given nothing, begun with first.snapshot; with
/// first.ot where there is no snapshot, or another mapping than the daemon's was given. Errors: an order.log
/// of another version or another number of joints; a file to begin with that is not the recording's, is
/// damaged, of another resolution than the mapping asks for, or of more memory. `depth`: null if there is
/// none. `begin`: of the recording, if it is known.
[[nodiscard]] Result<OrderedPlayback, AppError> play_in_order(const PlaybackRequest& request,
                                                              const rig::Rig& rig, Pipeline& pipeline,
                                                              DepthSource* depth,
                                                              std::optional<HostTime> begin,
                                                              const ReplayReport& report);

}  // namespace octoskin
