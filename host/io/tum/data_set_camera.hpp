// The cameras of published data sets, and the one that a data set has a file of.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::tum {

/// The first is what the TUM RGB-D benchmark says to use for all its depth images, which the driver has
/// registered to the colour camera and taken the distortion out of; freiburg1 to 3 are calibrations of its
/// three colour cameras.
inline constexpr std::array<std::string_view, 6> kDataSetCameras{"kinect",    "freiburg1", "freiburg2",
                                                                 "freiburg3", "icl_nuim",  "seven_scenes"};

/// One of kDataSetCameras; empty for any other name.
[[nodiscard]] std::optional<CameraIntrinsics> data_set_camera(std::string_view name);

/// Of `calibration`: the four numbers fx fy cx cy, or a 3 x 3 matrix; pixel centres have whole numbers in
/// both. Size: that of `image`. Errors name the file.
[[nodiscard]] Result<CameraIntrinsics, DepthSourceError> calibrated_camera(const FilePlace& calibration,
                                                                           const FilePlace& image);

}  // namespace octoskin::tum
