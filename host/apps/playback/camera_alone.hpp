// Playback of a camera without bus and robot: a data set, or an .oni file on its own.
#pragma once

#include <cstdint>
#include <filesystem>
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
/// One of tum::kDataSetCameras. Error: `usage` if there is no camera with this name.
[[nodiscard]] Result<rig::Camera, AppError> named_camera(std::string_view name);

/// The rig of the request with one camera: its only one, or the one that the request names. Empty if the
/// request has no rig. Errors: bad_config if the rig has no camera, for the images of `seen`; usage if it has
/// several and none is named, or none of that name.
[[nodiscard]] Result<std::optional<rig::Rig>, AppError> rig_with_camera(const PlaybackRequest& request,
                                                                        const std::string& seen);

/// Error (usage): the request has a robot. `file` is played, and `kind` is what it is.
[[nodiscard]] Status<AppError> check_options_of_camera(const PlaybackRequest& request,
                                                       const std::filesystem::path& file,
                                                       const std::string& kind);

/// A rig that contains only this camera.
[[nodiscard]] rig::Rig rig_of_camera(const rig::Camera& camera, const std::string& name);
/// Plays all `images` into maps, in the frame of the camera's poses; no robot is removed from the images.
/// `rig`: contains only the camera. `crc32`: of the image source. The result has those counter tables of the
/// pipeline that are not empty.
[[nodiscard]] Result<Playback, AppError> play_camera(PlaybackRequest request, rig::Rig rig,
                                                     std::uint32_t crc32, DepthSource& images,
                                                     const ReplayReport& report);

}  // namespace octoskin
