// The cameras of the TUM RGB-D benchmark.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin::tum {

/// The first is what the benchmark says to use for all its depth images, which the driver has registered to
/// the colour camera and taken the distortion out of; the others are calibrations of the three colour
/// cameras.
inline constexpr std::array<std::string_view, 4> kDataSetCameras{"kinect", "freiburg1", "freiburg2",
                                                                 "freiburg3"};

/// One of kDataSetCameras; empty for any other name. Source:
/// https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats "Intrinsic Camera Calibration of the
/// Kinect"
[[nodiscard]] std::optional<CameraIntrinsics> data_set_camera(std::string_view name);

}  // namespace octoskin::tum
