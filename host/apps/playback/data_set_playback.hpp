// A data set in the TUM RGB-D layout, in place of a recording: depth images of a camera that moved, no bus,
// no robot.
#pragma once

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"

namespace octoskin {

/// Whether the directory has a depth.txt and no can.log.
[[nodiscard]] bool is_data_set(const RecordingPaths& recording);

/// That the request asks for nothing that a data set does not have: a robot, both a rig and a camera.
[[nodiscard]] Status<AppError> check_data_set(const PlaybackRequest& request);

/// Plays the images in the order of their times and at the pace asked for, each from where the camera was,
/// into the maps of a pipeline. Of the rig, if one is given, it takes `camera`, but for its pose: the map's
/// frame is that of the data set.
[[nodiscard]] Result<Playback, AppError> play_data_set(const PlaybackRequest& request,
                                                       const ReplayReport& report);

}  // namespace octoskin
