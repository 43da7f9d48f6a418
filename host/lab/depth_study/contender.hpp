// What a depth study compares: noises of the simulated camera, and configurations that are given a noise.
#pragma once

#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/depth/noise_law.hpp"
#include "hw/sim/camera/depth_noise.hpp"

namespace octoskin::depth_study {

struct NamedNoise {
    std::string name;  ///< as in the command line: "0.03", "kinect"
    sim::DepthNoise noise;
    DepthNoiseLaw law;  ///< its deviation at each depth; a Kinect's bias, edges and steps are not in it
};

/// "kinect", or a deviation in metres from 0.001 to 0.1. Error (usage, key --noise): anything else.
[[nodiscard]] Result<NamedNoise, AppError> named_noise(const std::string& text);

/// A configuration, given a multiple of the camera's noise.
struct Contender {
    std::string configuration;
    double sigma_factor = 1.0;
    MappingConfig mapping;

    [[nodiscard]] std::string label() const;  ///< "fast", "fast x0.5"
};

/// Each configuration with each factor; one that does not remove noise only once. The denoiser gets `law`, a
/// filter its deviation at 2.5 m, both in place of their own. The robot is not removed: there is none.
/// Errors: a noise that the configuration does not accept (usage, key --sigma-factor); a configuration for
/// images without noise (usage, key --configurations).
[[nodiscard]] Result<std::vector<Contender>, AppError> contenders_of(
    const std::vector<NamedMapping>& configurations, const std::vector<double>& sigma_factors,
    const DepthNoiseLaw& law);

}  // namespace octoskin::depth_study
