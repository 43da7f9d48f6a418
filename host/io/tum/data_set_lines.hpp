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

/// Of depth.txt: "1305031102.160407 depth/1305031102.160407.png". Of a list that has the colour image beside
/// it: "0 depth/0.png 0 rgb/0.png", in either order; the depth image is the one whose name says so.
struct ImageLine {
    HostTime captured;  ///< of the data set's own clock, seconds since 1970
    std::string file;   ///< relative to the data set
};

/// Of groundtruth.txt: "1305031102.1758 1.34 0.63 1.66 0.66 0.62 -0.29 -0.30", time, metres, quaternion xyzw.
struct PoseLine {
    HostTime at;
    /// Of the optical frame, with the axes that the data set gives it. Empty: the line says that it is not
    /// known, with a number that is not finite, or a quaternion of zeros.
    std::optional<Eigen::Isometry3d> T_map_camera;
};

/// Times are decimals, with or without an exponent, read exactly to the nanosecond; digits behind it are left
/// out. Errors say what is wrong with the line.
[[nodiscard]] Result<ImageLine, std::string> parse_image_line(std::string_view line);
/// The same; also refused: what is over 10^6 m, a quaternion whose length is not 1 within 0.01.
[[nodiscard]] Result<PoseLine, std::string> parse_pose_line(std::string_view line);

/// Sixteen numbers, row by row: the matrix that takes points of the camera into the map. Empty: it says that
/// the pose is not known, with a number that is not finite, or with nothing but zeros. Refused: no rotation
/// within 0.01, over 10^6 m, a last row that is not 0 0 0 1.
[[nodiscard]] Result<std::optional<Eigen::Isometry3d>, std::string> parse_pose_matrix(std::string_view text);

/// All numbers of a text, at most `count_max` of them. Refused: a word that is no number, more numbers.
[[nodiscard]] Result<std::vector<double>, std::string> parse_numbers(std::string_view text,
                                                                     std::size_t count_max);

}  // namespace octoskin::tum
