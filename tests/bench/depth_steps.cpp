#include "tests/bench/depth_steps.hpp"

#include <ctime>
#include <stdexcept>

#include "host/core/depth/depth_image.hpp"
#include "host/core/self_filter/robot_filter.hpp"

namespace octoskin::bench {

DepthSteps::DepthSteps(const HostRig& rig, const MappingConfig& config)
    : camera_(rig.cameras.at(0)),
      config_(config),
      self_margin_m_(rig.depth_self_margin_m),
      filter_(config.depth_filter),
      integrator_(config, camera_.intrinsics),
      map_(config.map) {
    if (config.depth_update == DepthUpdate::denoised)
        denoiser_.emplace(config.depth_denoiser, camera_.intrinsics);
}

template <class Step>
void DepthSteps::time(const char* name, const Step& step) {
    const std::clock_t begin = std::clock();
    step();
    times_ms_[name].push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
}

void DepthSteps::remove_arm(DepthImage& image, const RobotPose& robot,
                            const Eigen::Isometry3d& T_map_camera) {
    time("self_filter", [&] {
        std::vector<PosedCapsule> body_camera = robot.body_base;
        for (PosedCapsule& capsule : body_camera) {
            capsule.p_a = T_map_camera.inverse() * capsule.p_a;
            capsule.p_b = T_map_camera.inverse() * capsule.p_b;
        }
        (void)remove_robot(image, integrator_.pixel_rays(), body_camera, self_margin_m_);
    });
}

void DepthSteps::clean(DepthImage& image, bool is_same_place) {
    if (denoiser_) {
        time("denoise", [&] {
            denoiser_->denoise(
                image, is_same_place ? DepthDenoiser::Memory::used : DepthDenoiser::Memory::of_other_place);
        });
    } else if (config_.depth_filter.is_enabled) {
        time("filter", [&] { filter_.filter(image); });
    }
}

void DepthSteps::take(const DepthFrame& frame, const RobotPose& robot) {
    const Eigen::Isometry3d T_map_camera = frame.T_map_camera.value_or(camera_.T_link_camera);
    const bool is_same_place =
        T_map_camera_before_ && T_map_camera_before_->matrix() == T_map_camera.matrix();
    DepthImage image;
    time("convert", [&] {
        image = to_depth_image(frame, {camera_.depth_min_m, camera_.depth_max_m}).value();
    });
    // As in DepthStage: the denoiser remembers what is behind the robot, the filter smooths its edges, too.
    if (denoiser_) remove_arm(image, robot, T_map_camera);
    clean(image, is_same_place);
    if (!denoiser_) remove_arm(image, robot, T_map_camera);
    DepthUpdates updates;
    time("integrate", [&] {
        ImageNotes notes;
        if (denoiser_) notes.doubts_m = denoiser_->doubts_m();
        if (denoiser_ && frame.T_map_camera) notes.miss_log_odds = config_.moving_miss_log_odds;
        auto result = integrator_.integrate(image, T_map_camera, notes);
        if (!result) throw std::runtime_error("a frame was refused");
        updates = std::move(result).value();
    });
    if (denoiser_) {
        time("ends", [&] {
            if (is_same_place)
                ends_.find(integrator_.rays(), denoiser_->changes(), updates.terms, updates.retracted);
            else
                ends_.forget();
            ends_.keep(integrator_.rays(), denoiser_->changes());
            denoiser_->keep();
        });
    }
    T_map_camera_before_ = T_map_camera;
    time("apply", [&] {
        map_.advance_time(frame.captured);
        if (!updates.retracted.empty()) map_.apply(updates.retracted);
        map_.apply(updates.terms);
    });
}

}  // namespace octoskin::bench
