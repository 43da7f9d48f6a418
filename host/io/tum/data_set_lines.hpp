// Lines of the TUM RGB-D layout: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"

namespace octoskin::tum {

/// A line of depth.txt: "1305031102.160407 depth/1305031102.160407.png". A list may contain the colour image,
/// too: "0 depth/0.png 0 rgb/0.png", in either order; the depth image is the one with "depth" in its name.
struct ImageLine {
    HostTime captured;  ///< on the data set's own clock, seconds since 1970
    std::string file;   ///< relative to the data set
};

/// A line of groundtruth.txt: "1305031102.1758 1.34 0.63 1.66 0.66 0.62 -0.29 -0.30": time, metres,
/// quaternion xyzw.
struct PoseLine {
    HostTime at;
    /// Pose of the optical frame, with the axes of the data set. Empty: the line marks the pose as unknown,
    /// by a number that is not finite, or by a zero quaternion.
    std::optional<Eigen::Isometry3d> T_map_camera;
};

/// Times are decimals, with or without an exponent, read exactly to the nanosecond; further digits are
/// dropped. The error is the fault of the line.
[[nodiscard]] Result<ImageLine, std::string> parse_image_line(std::string_view line);
/// Likewise. Also errors: a position over 10^6 m, a quaternion whose length is not 1 within 0.01.
[[nodiscard]] Result<PoseLine, std::string> parse_pose_line(std::string_view line);

/// Sixteen numbers, row by row: the matrix that transforms points from the camera to the map. Empty: the pose
/// is marked as unknown, by a number that is not finite, or by zeros only. Errors: not a rotation within
/// 0.01, over 10^6 m, a last row other than 0 0 0 1.
[[nodiscard]] Result<std::optional<Eigen::Isometry3d>, std::string> parse_pose_matrix(std::string_view text);

/// All numbers of a text, at most `count_max`. Errors: a word that is not a number, more numbers.
[[nodiscard]] Result<std::vector<double>, std::string> parse_numbers(std::string_view text,
                                                                     std::size_t count_max);

}  // namespace octoskin::tum
