#include "host/lab/depth_study/contender.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>

namespace octoskin::depth_study {
namespace {

constexpr double kSigmaMin_m = 0.001;
constexpr double kSigmaMax_m = 0.1;
/// A filter has one deviation for all depths; MappingConfig::camera_sigma_m() uses the same depth.
constexpr double kFilterDepth_m = 2.5;

NamedNoise kinect(const std::string& name) {
    const sim::KinectNoise noise;
    return {name,
            {noise},
            {noise.sigma_min_m, noise.sigma_growth_per_m, noise.sigma_min_at_m, noise.bias_growth_per_m}};
}

std::optional<double> sigma_of(const std::string& text) {
    double sigma_m = 0.0;
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, sigma_m);
    if (parsed.ec != std::errc{} || parsed.ptr != end) return std::nullopt;
    if (!(sigma_m >= kSigmaMin_m && sigma_m <= kSigmaMax_m)) return std::nullopt;
    return sigma_m;
}

Result<MappingConfig, AppError> given_noise(MappingConfig mapping, const DepthNoiseLaw& law, double factor) {
    mapping.removes_robot_from_depth = false;
    mapping.depth_denoiser.noise = {factor * law.constant_m, factor * law.quadratic_per_m, law.from_m,
                                    law.bias_per_m};
    mapping.depth_filter.sigma_m = factor * law.sigma_m(kFilterDepth_m);
    const double gate_m = std::max(mapping.depth_filter.gate_m(), mapping.depth_filter.mean_gate_m());
    if (mapping.depth_filter.is_enabled && gate_m > DepthFilterConfig::kGateMax_m) {
        return fail(ExitCode::usage, {.code = ErrorCode::out_of_range,
                                      .what = fmt::format("expected gates of the filter of at most {} m",
                                                          DepthFilterConfig::kGateMax_m),
                                      .value = fmt::format("{} m", gate_m),
                                      .key = "--sigma-factor"});
    }
    return mapping;
}

Status<AppError> check_takes_noise(const NamedMapping& configuration) {
    if (!configuration.is_depth_noise_free) return Done{};
    return fail(ExitCode::usage, {.code = ErrorCode::unsupported,
                                  .what = "expected a configuration for noisy images",
                                  .value = "'" + configuration.name + "'",
                                  .key = "--configurations"});
}

}  // namespace

Result<NamedNoise, AppError> named_noise(const std::string& text) {
    if (text == "kinect") return kinect(text);
    if (const auto sigma_m = sigma_of(text))
        return NamedNoise{text, sim::gaussian_noise(*sigma_m), {*sigma_m}};
    return fail(ExitCode::usage,
                {.code = ErrorCode::bad_value,
                 .what = fmt::format("expected 'kinect', or metres from {} to {}", kSigmaMin_m, kSigmaMax_m),
                 .value = "'" + text + "'",
                 .key = "--noise"});
}

std::string Contender::label() const {
    return sigma_factor == 1.0 ? configuration : fmt::format("{} x{}", configuration, sigma_factor);
}

Result<std::vector<Contender>, AppError> contenders_of(const std::vector<NamedMapping>& configurations,
                                                       const std::vector<double>& sigma_factors,
                                                       const DepthNoiseLaw& law) {
    std::vector<Contender> contenders;
    for (const NamedMapping& configuration : configurations) {
        if (auto checked = check_takes_noise(configuration); !checked) return unexpected(checked.error());
        const bool uses_noise = configuration.mapping.removes_camera_noise();
        for (const double factor : uses_noise ? sigma_factors : std::vector<double>{1.0}) {
            auto mapping = given_noise(configuration.mapping, law, factor);
            if (!mapping) return unexpected(mapping.error());
            contenders.push_back({configuration.name, factor, std::move(*mapping)});
        }
    }
    return contenders;
}

}  // namespace octoskin::depth_study
