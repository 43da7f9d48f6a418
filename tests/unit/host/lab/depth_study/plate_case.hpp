// A plate before a small camera, as one case of a depth study.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "host/lab/depth_study/seen_study.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/study/configurations.hpp"
#include "tests/unit/host/lab/evaluation/keys.hpp"

namespace octoskin::depth_study {

/// At the origin, looks along +x: image right is -y. 10 images a second.
inline rig::Camera small_camera() {
    rig::Camera camera{.width = 81, .height = 61, .fx = 100.0, .fy = 100.0, .cx = 40.5, .cy = 30.5};
    camera.rate_hz = 10.0;
    camera.depth_min_m = 0.3;
    camera.depth_max_m = 4.5;
    camera.T_link_camera = evaluation::T_base_camera_of({{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}});
    return camera;
}

/// Faces in the middle of voxels: the camera sees the plate's front, 10 x 10 voxels. The wall is not judged.
inline sim::World plate_world() {
    return sim::World({evaluation::box("plate", {2.02, -0.18, -0.18}, {2.30, 0.18, 0.18}),
                       evaluation::box("wall", {4.0, -6.0, -6.0}, {4.2, 6.0, 6.0})});
}

inline sim::Scenario plate_scenario() {
    sim::Scenario scenario;
    scenario.name = "plate";
    scenario.region = {{0.4, -0.4, -0.4}, {2.6, 0.4, 0.4}, std::nullopt};
    return scenario;
}

/// The lowest noise that a denoiser accepts, of a camera without any.
inline NamedNoise no_noise() {
    return {"none", sim::gaussian_noise(0.0), {.constant_m = 0.001}};
}

/// Built-in configurations, each with each factor.
inline std::vector<Contender> contenders(const std::vector<std::string>& names, const NamedNoise& noise,
                                         const std::vector<double>& sigma_factors = {1.0}) {
    auto found = contenders_of(find_configurations(names).value(), sigma_factors, noise.law);
    EXPECT_TRUE(found) << found.error().message();
    return std::move(*found);
}

/// What a DepthCase refers to.
class PlateCase {
  public:
    PlateCase(NamedNoise noise, std::vector<Contender> contenders)
        : noise_(std::move(noise)), contenders_(std::move(contenders)) {}

    [[nodiscard]] DepthCase of_seed(std::uint64_t seed) const {
        return {.world = world_,
                .scenario = scenario_,
                .camera = camera_,
                .T_map_base = Eigen::Isometry3d::Identity(),
                .noise = noise_,
                .seed = seed,
                .contenders = contenders_};
    }

  private:
    sim::World world_ = plate_world();
    sim::Scenario scenario_ = plate_scenario();
    rig::Camera camera_ = small_camera();
    NamedNoise noise_;
    std::vector<Contender> contenders_;
};

}  // namespace octoskin::depth_study
