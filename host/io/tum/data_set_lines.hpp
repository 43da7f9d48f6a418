// Lines of the TUM RGB-D layout: https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "common/time.hpp"

namespace octoskin::tum {

/// Of depth.txt: "1305031102.160407 depth/1305031102.160407.png".
struct ImageLine {
    HostTime captured;  ///< of the data set's own clock, seconds since 1970
    std::string file;   ///< relative to the data set
};

/// Of groundtruth.txt: "1305031102.1758 1.34 0.63 1.66 0.66 0.62 -0.29 -0.30", time, metres, quaternion xyzw.
struct PoseLine {
    HostTime at;
    Eigen::Isometry3d T_map_camera;  ///< of the optical frame: z forward, x right, y down
};

/// Errors say what is wrong with the line. Digits of a time behind the ninth decimal are left out.
[[nodiscard]] Result<ImageLine, std::string> parse_image_line(std::string_view line);
/// The same; also refused: what is not finite or over 10^6 m, a quaternion whose length is not 1 within 0.01.
[[nodiscard]] Result<PoseLine, std::string> parse_pose_line(std::string_view line);

}  // namespace octoskin::tum
