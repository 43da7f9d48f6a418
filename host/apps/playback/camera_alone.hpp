// What a camera without a bus and a robot is played with: a data set, or an .oni file that stands alone.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/pipeline/can_source.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

class NoBus final : public CanSource {
  public:
    [[nodiscard]] Result<std::optional<StampedFrame>, CanSourceError> next() override {
        return std::optional<StampedFrame>{};
    }
};

/// Depth from 0.5 to 4.5 m, 30 images a second.
[[nodiscard]] rig::Camera camera_with(const CameraIntrinsics& intrinsics);
/// One of tum::kDataSetCameras; usage, if there is none of this name.
[[nodiscard]] Result<rig::Camera, AppError> named_camera(std::string_view name);

/// The rig that is given; empty if none is. bad_config, if it has no camera that `seen` could be seen by.
[[nodiscard]] Result<std::optional<rig::Rig>, AppError> rig_with_camera(const PlaybackRequest& request,
                                                                        const std::string& seen);

/// A camera, and nothing else.
[[nodiscard]] rig::Rig rig_of_camera(const rig::Camera& camera, const std::string& name);
/// Its map is in the frame that the camera's pose is in. No robot is taken out of the images.
[[nodiscard]] Result<Pipeline, AppError> pipeline_of_camera(PlaybackRequest request, const rig::Rig& rig);

}  // namespace octoskin
