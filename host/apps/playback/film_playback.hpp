// An .oni file that stands alone, as NiViewer records it: the depth of a camera that did not move, no bus, no
// robot's joints.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"

namespace octoskin {

/// The file that was named, if its name ends with .oni; or the only such file of a folder that is no
/// recording (no can.log, meta.yaml or order.log) and no data set. Empty: there is none, or more than one.
[[nodiscard]] std::optional<FilePlace> lone_film(const RecordingPaths& recording);

/// That the request says where the camera was (`T_map_camera`, or a rig), and asks for nothing that a film
/// does not have.
[[nodiscard]] Status<AppError> check_film(const PlaybackRequest& request);

/// Plays the images in their order and at the pace asked for. The camera is that of the rig, if one is
/// given, else the named one. It was at `T_map_camera`, else where the rig has it.
[[nodiscard]] Result<Playback, AppError> play_film(const PlaybackRequest& request,
                                                   const ReplayReport& report);

}  // namespace octoskin
