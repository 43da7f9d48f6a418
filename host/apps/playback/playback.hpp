// From a recording on disk to maps: opens the files, runs the host's pipeline and collects the input
// counters.
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
#include "host/apps/robot/given_robot.hpp"
#include "host/core/counters/input_counters.hpp"
#include "host/core/counters/loss.hpp"
#include "host/core/ingest/node_summary.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/pipeline/replay.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The error of unreadable depth frames: `unavailable` if the reader program is missing, else `bad_data`.
[[nodiscard]] inline AppError unread_depth(const Error& error) {
    return {error.code == ErrorCode::no_program ? ExitCode::unavailable : ExitCode::bad_data, error};
}

struct PlaybackRequest {
    RecordingPaths recording;
    MappingConfig mapping;
    std::string configuration;      ///< name of `mapping`
    bool is_mapping_given = false;  ///< used in place of the recording's
    std::vector<MapFeed> maps = every_feed();
    std::filesystem::path rig;  ///< used in place of the recording's; empty: the recording's
    GivenRobot robot;           ///< used in place of the recording's
    /// For a data set or an .oni file: without a rig one of tum::kDataSetCameras (empty: the camera of the
    /// data set's layout, or the first one), with a rig the name of one of its cameras (empty: its only one).
    std::string camera = {};
    /// For an .oni file on its own: the camera's pose. Empty: the rig's.
    std::optional<Eigen::Isometry3d> T_map_camera = {};
    /// Play in the order of capture times, even if the recording contains the daemon's order.
    bool is_by_capture_time = false;
    Pace pace = {};
    /// Called for everything that enters the maps; null: no listener.
    CommitListener* listener = nullptr;
    /// Called before the playback with warnings about rig and robot; empty: they are among the warnings at
    /// the end.
    std::function<void(const std::string& warning)> warn_first = {};
    /// Called before the playback with the number of bytes read for the checksum of the recording.
    BytesReport on_checksum = {};
};

struct Playback {
    rig::Rig rig;
    Pipeline pipeline;  ///< finished, with its maps and input counters
    ReplayOutcome outcome;
    std::vector<CounterTable> inputs;  ///< log lines, then the pipeline's, then the pixels
    std::vector<NodeSummary> nodes;    ///< the state of each node at the end
    /// Links that use another link's body; notable behaviour of the host's clock.
    std::vector<std::string> notes;
    std::vector<std::string> warnings;  ///< for the user, about this recording
    /// Inputs of which more than half was rejected. Those that a user can correct are among the warnings, the
    /// rest among the notes.
    std::vector<Loss> losses = {};
    bool is_map_incomplete = false;  ///< a map had no room for some of its voxels
    MapOrigin origin;                ///< of its maps, without the maps' own checksums
    /// Played in a daemon's order and with its mapping: what had no room in `fused` had none in the daemon's
    /// map either.
    bool is_as_full_as_daemons = false;
    /// Played in a daemon's order, and `fused` differs from its map although nothing given explains that.
    bool is_unlike_daemons = false;
};

/// Why the result must not be used as a map; empty if there is no reason against it. Reasons: a source failed
/// during the playback, the input counters do not balance, a map had no room, or no map contains anything.
/// `where_the_counters_are`: half a sentence on where to find the counters that explain an empty map.
[[nodiscard]] std::optional<AppError> failure_of(
    const Playback& playback,
    std::string_view where_the_counters_are = "`octoskin replay` shows the counters with the reason");

/// An error if more than half of the usable input is lost for reasons that a user can correct; the maps then
/// contain only the rest. Empty if not.
[[nodiscard]] std::optional<AppError> loss_of(const Playback& playback);

/// Checks that the recording has its files, as check_recording() does. Cheap; for callers that prepare
/// something before the playback.
[[nodiscard]] Status<AppError> check_playable(const PlaybackRequest& request);

/// Opens a recording and plays it to its end: in a daemon's own order, if it contains one. A data set in the
/// TUM RGB-D layout is played as well (data_set_playback.hpp). If a source fails during the playback (a
/// truncated .oni), `outcome` contains the error, and the maps contain what was read before it. Several
/// threads may play at once. During a playback no octoskin replaces the recording.
[[nodiscard]] Result<Playback, AppError> play_recording(const PlaybackRequest& request,
                                                        const ReplayReport& report = {});

}  // namespace octoskin
