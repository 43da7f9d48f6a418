// A frame of a depth camera, independent of its source.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/lens/lens_distortion.hpp"
#include "common/time.hpp"

namespace octoskin {

/// The ray through a pixel's centre is ((u + 0.5 - cx) / fx, (v + 0.5 - cy) / fy, 1) for a pinhole camera.
/// With a lens, this is the distorted image of the ray (PixelRays).
struct CameraIntrinsics {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    double fx = 0.0;
    double fy = 0.0;
    double cx = 0.0;
    double cy = 0.0;
    LensDistortion lens = {};
};

/// Row-major depth along the optical axis in millimetres, 0 = no value.
struct DepthFrame {
    HostTime captured;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint16_t> depth_mm;
    /// Pose of the optical frame of a moving camera at the capture time. Empty: the pose of the rig.
    std::optional<Eigen::Isometry3d> T_map_camera = std::nullopt;
    std::uint8_t camera = 0;  ///< index in HostRig::cameras
};

/// Depth along the optical axis in metres, height x width row-major; NaN = no value. Input and output of
/// filters.
struct DepthImage {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<float> depth_m;
};

}  // namespace octoskin
