// From a recording on disk to maps: the files opened, the host's pipeline run, the account drawn up.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/playback/map_origin.hpp"
#include "host/apps/playback/pace.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/core/account/account.hpp"
#include "host/core/account/loss.hpp"
#include "host/core/ingest/node_summary.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/pipeline/replay.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// Of depth frames that cannot be read: `unavailable` without the program that reads them, else `bad_data`.
[[nodiscard]] inline AppError unread_depth(const DepthSourceError& error) {
    return {error.is_reader_missing ? ExitCode::unavailable : ExitCode::bad_data, error.what};
}

struct PlaybackRequest {
    RecordingPaths recording;
    MappingConfig mapping;
    std::string configuration;      ///< what `mapping` is called
    bool is_mapping_given = false;  ///< in place of the recording's
    std::vector<MapFeed> maps = every_feed();
    std::filesystem::path rig;    ///< in place of the recording's; empty: the recording's
    std::filesystem::path robot;  ///< in place of the recording's; empty: the recording's
    /// Of a data set or a lone .oni for which no rig is given, one of tum::kDataSetCameras; empty: that of
    /// the data set's layout, or the first.
    std::string camera = {};
    /// Of an .oni file that stands alone: where its camera was. Empty: where the rig has it.
    std::optional<Eigen::Isometry3d> T_map_camera = {};
    /// In the order of capture times, even if the recording has a daemon's own order.
    bool is_by_capture_time = false;
    Pace pace = {};
    /// Is told of what goes into the maps; null: nobody is.
    CommitListener* listener = nullptr;
    /// Is told, before anything is played, what a person should know about rig and robot; empty: that is
    /// among the warnings at the end.
    std::function<void(const std::string& warning)> warn_first = {};
    /// Is told, before anything is played, how much of the recording's files was read for their checksum.
    BytesReport on_checksum = {};
};

struct Playback {
    rig::Rig rig;
    Pipeline pipeline;  ///< finished: its maps and its accounts
    ReplayOutcome outcome;
    std::vector<AccountTable> accounts;  ///< log lines, then the pipeline's, then the pixels
    std::vector<NodeSummary> nodes;      ///< how each stood at the end
    /// Links with another's body; how the host's clock fared, if there is something to tell.
    std::vector<std::string> notes;
    std::vector<std::string> warnings;  ///< what a person should know about this recording
    /// Of what over half is rejected; those that a user can mend are among the warnings, the rest are notes.
    std::vector<Loss> losses = {};
    bool is_map_incomplete = false;  ///< a map had no room for some of its voxels
    MapOrigin origin;                ///< of its maps, but for the maps' own checksums
    /// Played in a daemon's order and with its mapping: what had no room in `fused` had none there either.
    bool is_as_full_as_daemons = false;
    /// Played in a daemon's order, and `fused` is not its map, though nothing given explains that.
    bool is_unlike_daemons = false;
};

/// Why what came of a recording must not be used as a map; empty if nothing speaks against it: a source that
/// failed on the way, an account that does not balance, a map without room, or nothing in any map.
/// `where_the_account_is`: half a sentence for whoever wonders why nothing came into a map.
[[nodiscard]] std::optional<AppError> failure_of(
    const Playback& playback,
    std::string_view where_the_account_is = "`octoskin replay` shows the account that says why");

/// That over half of what could have been used is lost for reasons that a user can mend: the maps are what
/// came of the rest. Empty if not.
[[nodiscard]] std::optional<AppError> loss_of(const Playback& playback);

/// That the recording has its files, as check_recording() says: cheap, for those who have something to
/// prepare before they play it.
[[nodiscard]] Status<AppError> check_playable(const PlaybackRequest& request);

/// Opens a recording and plays it to its end: in a daemon's own order, if it has one. A data set in the TUM
/// RGB-D layout is played as well (data_set_playback.hpp). A source that fails on the way (a truncated .oni)
/// is told in `outcome`, and what came before it is on the maps. Several threads may play at once; while one
/// does, no octoskin replaces the recording.
[[nodiscard]] Result<Playback, AppError> play_recording(const PlaybackRequest& request,
                                                        const ReplayReport& report = {});

}  // namespace octoskin
