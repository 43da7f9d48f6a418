#include "host/core/pipeline/depth_stage.hpp"

#include <cassert>

#include "host/core/depth/depth_image.hpp"
#include "host/core/self_filter/robot_filter.hpp"

namespace octoskin {
namespace {

DepthReason reason_of(DepthRejection rejection) {
    switch (rejection) {
        case DepthRejection::size_differs:
            return DepthReason::wrong_size;
        case DepthRejection::pose_not_finite:
        case DepthRejection::camera_outside_map:
            return DepthReason::outside_map;
        case DepthRejection::box_too_large:
            return DepthReason::box_too_large;
    }
    return DepthReason::outside_map;
}

}  // namespace

DepthStage::DepthStage(const HostRig& rig, const MappingConfig& config, unsigned threads, bool finds_certain)
    : camera_(rig.camera.value()),
      config_(config),
      self_margin_m_(rig.depth_self_margin_m),
      T_map_base_(rig.T_map_base),
      T_map_camera_(rig.T_map_base * camera_.T_base_camera),
      filter_(config.depth_filter),
      integrator_(config, camera_.intrinsics, threads) {
    if (finds_certain)
        certain_.emplace(camera_.intrinsics, CertaintyConfig{.camera_sigma_m = config.depth_filter.sigma_m,
                                                             .is_filtered = config.depth_filter.is_enabled});
}

std::uint64_t DepthStage::take_robot_out(DepthImage& image, const RobotPose& robot,
                                         const Eigen::Isometry3d& T_base_camera) {
    const Eigen::Isometry3d T_camera_base = T_base_camera.inverse();
    body_camera_ = robot.body_base;
    for (PosedCapsule& capsule : body_camera_) {
        capsule.p_a = T_camera_base * capsule.p_a;
        capsule.p_b = T_camera_base * capsule.p_b;
    }
    return remove_robot(image, integrator_.pixel_rays(), body_camera_, self_margin_m_);
}

Result<DepthUpdates, DepthReason> DepthStage::updates(const DepthFrame& frame, const RobotPose* robot) {
    assert(robot != nullptr || !needs_robot());
    Result<DepthImage, DepthFrameFault> converted =
        to_depth_image(frame, {camera_.depth_min_m, camera_.depth_max_m});
    if (!converted || converted->width != camera_.intrinsics.width ||
        converted->height != camera_.intrinsics.height) {
        wrong_size_ = {wrong_size_.frames + 1, frame.width, frame.height};
        return unexpected(DepthReason::wrong_size);
    }
    DepthImage image = std::move(converted).value();
    if (certain_) {
        raw_ = image;
    }
    if (config_.depth_filter.is_enabled) {
        filter_.filter(image);
    }
    const Eigen::Isometry3d T_base_camera =
        frame.T_map_camera ? T_map_base_.inverse() * *frame.T_map_camera : camera_.T_base_camera;
    if (certain_) {
        seen_.everything = image;
    }
    const std::uint64_t robot_pixels = needs_robot() ? take_robot_out(image, *robot, T_base_camera) : 0;
    Result<DepthUpdates, DepthRejection> updates = integrator_.integrate(image, T_map_camera_of(frame));
    if (!updates) {
        return unexpected(reason_of(updates.error()));
    }
    if (certain_) {
        certain_->find(raw_, seen_.everything, seen_.certainty);
        seen_.world = std::move(image);
    }
    robot_pixels_ += robot_pixels;
    pixels_ += updates->pixels;
    return std::move(updates).value();
}

}  // namespace octoskin
