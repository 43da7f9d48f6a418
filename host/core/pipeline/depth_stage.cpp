#include "host/core/pipeline/depth_stage.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <span>

#include "host/core/depth/depth_image.hpp"
#include "host/core/self_filter/robot_filter.hpp"

namespace octoskin {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

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

/// The filter of the mapping; with `denoised`, which has none, that of the images for the cross-check.
DepthFilterConfig filter_of(const MappingConfig& config) {
    if (config.depth_update != DepthUpdate::denoised) return config.depth_filter;
    DepthFilterConfig filter{.is_enabled = true};
    const double sigma_max_m =
        DepthFilterConfig::kGateMax_m / std::max(filter.gate_sigmas, filter.mean_sigmas);
    filter.sigma_m = std::min(config.camera_sigma_m(), sigma_max_m);
    return filter;
}

}  // namespace

MappingConfig mapping_of(const HostCamera& camera, MappingConfig config) {
    if (!camera.noise) return config;
    config.depth_denoiser.noise = *camera.noise;
    if (config.depth_update != DepthUpdate::denoised)
        config.depth_filter.sigma_m = camera.noise->sigma_m(MappingConfig::kUsualDepth_m);
    return config;
}

DepthStage::DepthStage(const HostRig& rig, const MappingConfig& config, unsigned threads, bool finds_certain,
                       std::size_t camera)
    : camera_(rig.cameras.at(camera)),
      config_(mapping_of(camera_, config)),
      self_margin_m_(rig.depth_self_margin_m),
      T_map_base_(rig.T_map_base),
      T_map_camera_(rig.T_map_base * camera_.T_link_camera),
      filter_(filter_of(config_)),
      integrator_(config_, camera_.intrinsics, threads) {
    if (config_.depth_update == DepthUpdate::denoised) {
        denoiser_.emplace(config_.depth_denoiser, camera_.intrinsics);
        ends_ = EndMemory(std::size_t{camera_.intrinsics.width} * camera_.intrinsics.height);
    }
    if (finds_certain)
        certain_.emplace(camera_.intrinsics, CertaintyConfig{.camera_sigma_m = config_.camera_sigma_m(),
                                                             .is_filtered = config_.removes_camera_noise()});
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

std::uint64_t DepthStage::filter(DepthImage& image, const DepthFrame& frame, const RobotPose* robot) {
    if (config_.depth_filter.is_enabled) filter_.filter(image);
    if (certain_) seen_.everything = image;
    return removes_robot() ? take_robot_out(image, *robot, T_base_camera_of(frame)) : 0;
}

/// The robot is removed first: so the memory keeps what is behind it while it passes.
std::uint64_t DepthStage::denoise(DepthImage& image, const DepthFrame& frame, const RobotPose* robot) {
    const auto memory =
        is_from_same_place(frame) ? DepthDenoiser::Memory::used : DepthDenoiser::Memory::of_other_place;
    const std::uint64_t robot_pixels =
        removes_robot() ? take_robot_out(image, *robot, T_base_camera_of(frame)) : 0;
    if (certain_) filter_for_cross_check(image);
    denoiser_->denoise(image, memory);
    return robot_pixels;
}

/// The cross-check judges single images: a mean over time has another noise, and holds back what differs.
void DepthStage::filter_for_cross_check(const DepthImage& without_robot) {
    seen_.everything = raw_;
    filter_.filter(seen_.everything);
    seen_.world = seen_.everything;
    for (std::size_t i = 0; i < seen_.world.depth_m.size(); ++i)
        if (std::isnan(without_robot.depth_m[i])) seen_.world.depth_m[i] = kNone;
}

bool DepthStage::is_from_same_place(const DepthFrame& frame) const {
    return T_map_camera_before_ && T_map_camera_before_->matrix() == T_map_camera_of(frame).matrix();
}

void DepthStage::keep(const DepthFrame& frame) {
    if (!denoiser_) return;
    if (!is_from_same_place(frame)) ends_.forget();
    ends_.keep(integrator_.rays(), denoiser_->changes());
    denoiser_->keep();
    T_map_camera_before_ = T_map_camera_of(frame);
}

std::optional<CameraMemory> DepthStage::memory() const {
    if (!denoiser_ || !T_map_camera_before_) return std::nullopt;
    CameraMemory memory{.name = camera_.name,
                        .width = denoiser_->width(),
                        .height = denoiser_->height(),
                        .T_map_camera = *T_map_camera_before_,
                        .pixels = {}};
    const std::span<const EndMemory::End> ends = ends_.ends();
    assert(ends.size() == std::size_t{memory.width} * memory.height);
    memory.pixels.reserve(ends.size());
    for (std::uint32_t v = 0; v < memory.height; ++v)
        for (std::uint32_t u = 0; u < memory.width; ++u)
            memory.pixels.push_back({denoiser_->pixel(u, v), ends[memory.pixels.size()]});
    return memory;
}

bool DepthStage::resume_with(const CameraMemory& memory) {
    assert(memory.pixels.size() == std::size_t{memory.width} * memory.height);
    const bool is_of_pose = !camera_.link.empty() || memory.T_map_camera.matrix() == T_map_camera_.matrix();
    const bool is_own = denoiser_ && memory.name == camera_.name && memory.width == denoiser_->width() &&
                        memory.height == denoiser_->height() && is_of_pose;
    if (!is_own) return false;
    std::vector<EndMemory::End> ends;
    ends.reserve(memory.pixels.size());
    for (const CameraMemory::Pixel& pixel : memory.pixels) ends.push_back(pixel.end);
    for (std::uint32_t v = 0; v < memory.height; ++v)
        for (std::uint32_t u = 0; u < memory.width; ++u)
            denoiser_->set_pixel(u, v, memory.pixels[std::size_t{v} * memory.width + u].depth);
    ends_.resume_with(std::move(ends));
    T_map_camera_before_ = memory.T_map_camera;
    return true;
}

Result<DepthUpdates, DepthReason> DepthStage::updates(const DepthFrame& frame, const RobotPose* robot) {
    assert(robot != nullptr || !needs_robot());
    assert(frame.T_map_camera || camera_.link.empty());
    Result<DepthImage, DepthFrameFault> converted =
        to_depth_image(frame, {camera_.depth_min_m, camera_.depth_max_m});
    if (!converted || converted->width != camera_.intrinsics.width ||
        converted->height != camera_.intrinsics.height) {
        return unexpected(DepthReason::wrong_size);
    }
    DepthImage image = std::move(converted).value();
    if (certain_) {
        raw_ = image;
    }
    const std::uint64_t robot_pixels = denoiser_ ? denoise(image, frame, robot) : filter(image, frame, robot);
    ImageNotes notes;
    if (denoiser_) notes.doubts_m = denoiser_->doubts_m();
    if (denoiser_ && frame.T_map_camera) notes.miss_log_odds = config_.moving_miss_log_odds;
    Result<DepthUpdates, DepthRejection> updates =
        integrator_.integrate(image, T_map_camera_of(frame), notes);
    if (!updates) {
        return unexpected(reason_of(updates.error()));
    }
    if (denoiser_ && is_from_same_place(frame))
        ends_.find(integrator_.rays(), denoiser_->changes(), updates->terms, updates->retracted);
    if (certain_) {
        certain_->find(raw_, seen_.everything, seen_.certainty);
        if (!denoiser_) seen_.world = std::move(image);
    }
    robot_pixels_ += robot_pixels;
    pixels_ += updates->pixels;
    return std::move(updates).value();
}

}  // namespace octoskin
