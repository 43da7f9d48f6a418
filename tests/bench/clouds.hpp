// The same frame and configuration for OctoMap and for us.
#pragma once

#include <octomap/octomap.h>

#include <cmath>
#include <string>

#include "host/core/depth/pixel_rays.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "tests/bench/room_frames.hpp"

namespace octoskin::bench {

/// Beyond it a point clears space up to here and marks nothing.
inline constexpr double kRangeMax_m = 4.0;

inline octomap::point3d origin_of(const RoomFrame& frame) {
    const Eigen::Vector3f origin = frame.T_map_camera.translation().cast<float>();
    return {origin.x(), origin.y(), origin.z()};
}

/// Without the pixels that have no value.
inline octomap::Pointcloud cloud_of(const RoomFrame& frame, const CameraIntrinsics& camera) {
    const PixelRays rays(camera);
    octomap::Pointcloud cloud;
    cloud.reserve(frame.image.depth_m.size());
    for (std::uint32_t i = 0; i < frame.image.depth_m.size(); ++i) {
        const RaySlope ray = rays.at(i % camera.width, i / camera.width);
        const double depth_m = static_cast<double>(frame.image.depth_m[i]);
        if (std::isnan(depth_m)) continue;
        const Eigen::Vector3f point =
            (frame.T_map_camera * (depth_m * Eigen::Vector3d(ray.x, ray.y, 1.0))).cast<float>();
        cloud.push_back(point.x(), point.y(), point.z());
    }
    return cloud;
}

/// Whatever is hit counts, so that a key's set can be told from its term.
inline MappingConfig bench_mapping(const std::string& resolution, DepthUpdate update) {
    MappingConfig config = mapping_with(update);
    config.map.resolution_m = std::stod(resolution);
    config.map.memory_max_mib = 8000;
    config.model.depth.range_min_m = 0.0;
    config.depth_range_max_m = kRangeMax_m;
    config.depth_box_voxels_max = 1U << 30U;
    return config;
}

}  // namespace octoskin::bench
