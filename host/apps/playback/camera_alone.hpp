// What a camera without a bus and a robot is played with: a data set, or an .oni file that stands alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/depth_source.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// Depth from 0.5 to 4.5 m, 30 images a second.
[[nodiscard]] rig::Camera camera_with(const CameraIntrinsics& intrinsics);
/// One of tum::kDataSetCameras; usage, if there is none of this name.
[[nodiscard]] Result<rig::Camera, AppError> named_camera(std::string_view name);

/// The rig that is given; empty if none is. bad_config, if it has no camera that `seen` could be seen by.
[[nodiscard]] Result<std::optional<rig::Rig>, AppError> rig_with_camera(const PlaybackRequest& request,
                                                                        const std::string& seen);

/// A camera, and nothing else.
[[nodiscard]] rig::Rig rig_of_camera(const rig::Camera& camera, const std::string& name);
/// Plays `images` to their end into maps in the frame that the camera's pose is in; no robot is taken out of
/// them. `rig`: of the camera alone. `crc32`: of what the images are read from. The accounts are those of the
/// pipeline that have something in them.
[[nodiscard]] Result<Playback, AppError> play_camera(PlaybackRequest request, rig::Rig rig,
                                                     std::uint32_t crc32, DepthSource& images,
                                                     const ReplayReport& report);

}  // namespace octoskin
