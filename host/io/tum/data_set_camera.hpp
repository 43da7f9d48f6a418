// The cameras of published data sets, and the calibration file of a data set.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::tum {

/// The first is the camera that the TUM RGB-D benchmark recommends for all its depth images: the driver has
/// registered these to the colour camera and undistorted them. freiburg1 to 3 are calibrations of the
/// benchmark's three colour cameras.
inline constexpr std::array<std::string_view, 6> kDataSetCameras{"kinect",    "freiburg1", "freiburg2",
                                                                 "freiburg3", "icl_nuim",  "seven_scenes"};

/// One of kDataSetCameras; empty for any other name.
[[nodiscard]] std::optional<CameraIntrinsics> data_set_camera(std::string_view name);

/// Reads `calibration`: the four numbers fx fy cx cy, or a 3 x 3 matrix; in both, pixel centres are whole
/// numbers. The size is that of `image`. Errors name the file.
[[nodiscard]] Result<CameraIntrinsics, Error> calibrated_camera(const FilePlace& calibration,
                                                                const FilePlace& image);

}  // namespace octoskin::tum
