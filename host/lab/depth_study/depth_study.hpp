// Depth updates on noisy images of worlds without a robot: scenarios x noises x seeds x configurations.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/lab/depth_study/hand_study.hpp"
#include "host/lab/depth_study/seen_study.hpp"

namespace octoskin::depth_study {

enum class DepthScene : std::uint8_t { stationary, moving, hand };

struct DepthRequest {
    std::vector<std::filesystem::path> scenarios;
    std::filesystem::path rig;  ///< of the camera
    std::vector<std::string> configurations;
    std::vector<std::string> noises;  ///< as named_noise()
    std::vector<double> sigma_factors{1.0};
    std::vector<std::uint64_t> seeds;
    std::vector<double> times_s;  ///< not empty; `moving` takes the largest only, `hand` none
    DepthScene scene = DepthScene::stationary;
    unsigned jobs = 1;
    std::function<void(const std::string& warning)> on_world_warning = {};
};

/// In the order of scenarios, noises and seeds, then of times, then of configurations and factors.
struct DepthResults {
    std::string program;
    std::string rig;  ///< its name
    DepthScene scene = DepthScene::stationary;
    std::vector<SeenFigures> seen;  ///< empty with `hand`
    std::vector<HandFigures> hand;  ///< with `hand` only
};

/// `say`: progress, one line for each scenario, noise and seed, called under a lock. Errors: unreadable
/// files, values that cannot be used, a rig with several cameras or without one that is on no link
/// (bad_config), a world with moving models unless `hand`. About 1 s for each second of images and
/// configuration.
[[nodiscard]] Result<DepthResults, AppError> run_depth_study(
    const DepthRequest& request, const std::function<void(const std::string&)>& say);

/// Tables for each noise: means of the seeds, with the worst seed in brackets; classes of thickness pooled.
[[nodiscard]] std::string depth_tables(const DepthResults& results);
/// All figures of each seed.
[[nodiscard]] std::string depth_json(const DepthResults& results);

}  // namespace octoskin::depth_study
