// What a depth camera sees of the furnished room: on its way round a corner of it, or from one place; and the
// images of a data set in its place.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/errors/error.hpp"

namespace octoskin::bench {

struct RoomFrame {
    DepthImage image;  ///< of whole millimetres
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
};

struct RoomFrames {
    CameraIntrinsics camera;
    std::vector<RoomFrame> frames;
    bool is_stationary = false;  ///< all of them from one place
    /// The place of the arm of the planner's rows, z up.
    Eigen::Isometry3d T_map_arm = Eigen::Isometry3d::Identity();
    /// Where the points of row `points` are.
    Eigen::AlignedBox3d asked{Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
    double mean_depth_m = 0.0;
    double share_beyond = 0.0;       ///< of pixels whose range is larger than `range_max_m`
    std::size_t without_return = 0;  ///< pixels; they are in neither of the two
};

/// The arm before a camera, in its view: half a metre below the axis and 0.8 m ahead.
[[nodiscard]] Eigen::Isometry3d arm_before_camera();

/// `count` frames with noise of 3 cm, in millimetres as a camera gives them. `is_stationary`: all from one
/// place of the way. About 20 ms a frame.
[[nodiscard]] Result<RoomFrames, Error> render_room(const std::filesystem::path& sdf,
                                                    const CameraIntrinsics& camera, bool is_stationary,
                                                    unsigned count, double range_max_m);

/// At most `count` images of a data set, evenly spread, with its own camera. Reads all images: about 5 ms
/// each. The error is the data set's, that there is none, or that no image of it has a pose.
[[nodiscard]] Result<RoomFrames, Error> read_frames(const std::filesystem::path& folder, unsigned count,
                                                    double range_max_m);

}  // namespace octoskin::bench
