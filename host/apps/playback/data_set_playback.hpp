// A data set in the TUM RGB-D layout in place of a recording: depth images of a moving camera, without bus
// and robot.
#pragma once

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"

namespace octoskin {

/// Whether the directory has a depth.txt and no can.log.
[[nodiscard]] bool is_data_set(const RecordingPaths& recording);

/// Checks that the request has no options that a data set cannot meet: a robot.
[[nodiscard]] Status<AppError> check_data_set(const PlaybackRequest& request);

/// Plays the images in the order of their times, at the requested pace, each from its camera pose, into the
/// maps of a pipeline. From a given rig it uses `camera` without its pose: the map's frame is that of the
/// data set.
[[nodiscard]] Result<Playback, AppError> play_data_set(const PlaybackRequest& request,
                                                       const ReplayReport& report);

}  // namespace octoskin
