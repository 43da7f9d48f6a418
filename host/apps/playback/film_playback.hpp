// An .oni file on its own, as NiViewer records it: depth of a stationary camera, without bus and joint
// states.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"

namespace octoskin {

/// The named file, if its name ends with .oni. For a folder that is neither a recording (no can.log,
/// meta.yaml or order.log) nor a data set: its only .oni file. Empty if there is none, or more than one.
[[nodiscard]] std::optional<FilePlace> lone_film(const RecordingPaths& recording);

/// Checks that the request contains the camera's pose (`T_map_camera`, or a rig), and no options that such a
/// file cannot meet.
[[nodiscard]] Status<AppError> check_film(const PlaybackRequest& request);

/// Plays the images in order, at the requested pace. The camera is the rig's if a rig is given, else the
/// named one. Its pose is `T_map_camera`, else the rig's.
[[nodiscard]] Result<Playback, AppError> play_film(const PlaybackRequest& request,
                                                   const ReplayReport& report);

}  // namespace octoskin
