// What a depth camera's earlier images have left for the next ones, apart from the map.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "host/core/depth/depth_denoiser.hpp"
#include "host/core/mapping/end_memory.hpp"

namespace octoskin {

/// After the last image that went into the map. 24 bytes a pixel.
struct CameraMemory {
    /// A pixel without a value so far is as constructed. Only a pixel with a value has an end.
    struct Pixel {
        DepthDenoiser::Pixel depth;
        EndMemory::End end;
        friend bool operator==(const Pixel&, const Pixel&) = default;
    };
    std::string name = {};  ///< of the camera in the rig; empty: the only one
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();  ///< of that image
    std::vector<Pixel> pixels;                                       ///< height x width, row-major
};

}  // namespace octoskin
