// Memories of depth cameras with every kind of pixel.
#pragma once

#include <cstdint>
#include <random>

#include "host/core/mapping/camera_memory.hpp"
#include "host/core/mapping/mapping_config.hpp"

namespace octoskin::testing_support {

/// A pixel with a value and an end, as few values as any.
[[nodiscard]] inline CameraMemory::Pixel seen_pixel() {
    return {.depth = {.mean_m = 1.5F, .count = 1.0F, .drift = 0.0F},
            .end = {.key_xy = 0x8001'8002U, .key_z = 0x8003U, .depth_m = 1.501F}};
}

/// About `share` of the pixels have a value; of these most have an end, some a value that is held back.
[[nodiscard]] inline CameraMemory random_camera(unsigned seed, std::uint32_t width, std::uint32_t height,
                                                float share = 0.7F) {
    const DepthDenoiserConfig limits;
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit;
    CameraMemory camera{.width = width, .height = height, .T_map_camera = {}, .pixels = {}};
    camera.T_map_camera = Eigen::Translation3d(0.5, -2.0, 1.0 / 3.0) *
                          Eigen::AngleAxisd(0.7 + seed, Eigen::Vector3d(1, 2, 3).normalized());
    for (std::size_t i = 0; i < std::size_t{width} * height; ++i) {
        CameraMemory::Pixel& pixel = camera.pixels.emplace_back();
        if (unit(random) >= share) continue;
        pixel = seen_pixel();
        pixel.depth.mean_m = 0.001F + 65.0F * unit(random);
        pixel.depth.count = static_cast<float>(1 + random() % limits.count_max);
        pixel.depth.drift = static_cast<float>(limits.drift_sigmas) * (2.0F * unit(random) - 1.0F);
        if (random() % 4 == 0) pixel.depth.count = -pixel.depth.count;
        pixel.end = {static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random() % 0x10000U),
                     0.001F + 65.0F * unit(random)};
        if (random() % 8 == 0) pixel.end = {};
    }
    return camera;
}

}  // namespace octoskin::testing_support
