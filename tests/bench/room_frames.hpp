// What a depth camera sees of the furnished room, on its way round a corner of it.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin::bench {

struct RoomFrame {
    DepthImage image;
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
};

struct RoomFrames {
    CameraIntrinsics camera;
    std::vector<RoomFrame> frames;
    double mean_depth_m = 0.0;
    double share_beyond = 0.0;       ///< of pixels whose range is larger than `range_max_m`
    std::size_t without_return = 0;  ///< pixels; they are in neither of the two
};

/// `count` frames with noise of 3 cm, in millimetres as a camera gives them. About 20 ms a frame.
[[nodiscard]] Result<RoomFrames, sim::Error> render_room(const std::filesystem::path& sdf,
                                                         const CameraIntrinsics& camera, unsigned count,
                                                         double range_max_m);

}  // namespace octoskin::bench
