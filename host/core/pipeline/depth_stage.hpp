// Converts the depth frames of one camera to the terms of their voxels: convert, filter, remove the robot,
// integrate.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/core/beams/robot_pose.hpp"
#include "host/core/cross_check/certain_pixels.hpp"
#include "host/core/cross_check/cross_check.hpp"
#include "host/core/depth/depth_denoiser.hpp"
#include "host/core/depth/depth_filter.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/mapping/camera_memory.hpp"
#include "host/core/mapping/depth_integrator.hpp"
#include "host/core/mapping/end_memory.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The mapping with the noise of a camera that has its own; its filter follows it.
[[nodiscard]] MappingConfig mapping_of(const HostCamera& camera, MappingConfig config);

class DepthStage {
  public:
    /// Of the rig's camera with this index (asserted). `finds_certain`: also finds the reliable pixels, for
    /// the comparison with range sensors.
    DepthStage(const HostRig& rig, const MappingConfig& config, unsigned threads = 1,
               bool finds_certain = false, std::size_t camera = 0);

    /// True if a frame requires the robot's pose: to remove the robot, or to place a camera on a link.
    [[nodiscard]] bool needs_robot() const noexcept {
        return config_.removes_robot_from_depth || !camera_.link.empty();
    }

    /// `robot`: at the frame's capture time; may be null unless `needs_robot()`.
    [[nodiscard]] Result<DepthUpdates, DepthReason> updates(const DepthFrame& frame, const RobotPose* robot);
    /// The frame that gave the last updates goes into the map: the next ones build on it. Frames that do not
    /// leave no trace. Throws std::bad_alloc the first time.
    void keep(const DepthFrame& frame);
    /// What the next frame builds on; empty if the update has no memory or no frame was kept. Another thread
    /// may be in `updates`, which does not change it, but not in `keep`. O(pixels). Throws std::bad_alloc.
    [[nodiscard]] std::optional<CameraMemory> memory() const;
    /// Continues from this memory, of as many pixels as its size says (asserted). False: nothing is changed,
    /// because the update has no memory, or the rig's camera has another name or size or, unless it is on a
    /// link, another pose. Throws std::bad_alloc.
    [[nodiscard]] bool resume_with(const CameraMemory& memory);
    /// The next frame builds on nothing.
    void forget() noexcept { T_map_camera_before_.reset(); }

    [[nodiscard]] const HostCamera& camera() const noexcept { return camera_; }
    /// Images of the newest frame that gave updates, for the comparison with range sensors; only if
    /// `finds_certain`. Swapped for `images`, whose memory is reused.
    void swap_images(SeenImages& images) noexcept { std::swap(seen_, images); }
    /// Camera pose of a frame.
    [[nodiscard]] Eigen::Isometry3d T_map_camera_of(const DepthFrame& frame) const {
        return frame.T_map_camera.value_or(T_map_camera_);
    }

    /// Number of frames refused as `wrong_size`, with the newest width and height (pixels).
    struct WrongSize {
        std::uint64_t frames = 0;
        std::uint32_t width = 0;
        std::uint32_t height = 0;
    };
    [[nodiscard]] const WrongSize& wrong_size() const noexcept { return wrong_size_; }
    /// `updates` has refused this frame as `wrong_size`. Not part of it: another thread may be in `updates`.
    void note_wrong_size(const DepthFrame& frame) noexcept {
        wrong_size_ = {wrong_size_.frames + 1, frame.width, frame.height};
    }

    /// Pixels removed because they show the robot, over all frames that went into the map.
    [[nodiscard]] std::uint64_t robot_pixels() const noexcept { return robot_pixels_; }
    /// Results of the other pixels, over all used frames.
    [[nodiscard]] const DepthPixelCounts& pixels() const noexcept { return pixels_; }

  private:
    [[nodiscard]] bool removes_robot() const noexcept { return config_.removes_robot_from_depth; }
    /// Each of the two removes noise and the robot; returns the number of the robot's pixels.
    [[nodiscard]] std::uint64_t filter(DepthImage& image, const DepthFrame& frame, const RobotPose* robot);
    [[nodiscard]] std::uint64_t denoise(DepthImage& image, const DepthFrame& frame, const RobotPose* robot);
    void filter_for_cross_check(const DepthImage& without_robot);
    [[nodiscard]] bool is_from_same_place(const DepthFrame& frame) const;
    [[nodiscard]] Eigen::Isometry3d T_base_camera_of(const DepthFrame& frame) const {
        return frame.T_map_camera ? T_map_base_.inverse() * *frame.T_map_camera : camera_.T_link_camera;
    }
    /// Returns the number of removed pixels.
    [[nodiscard]] std::uint64_t take_robot_out(DepthImage& image, const RobotPose& robot,
                                               const Eigen::Isometry3d& T_base_camera);

    HostCamera camera_;
    MappingConfig config_;
    double self_margin_m_;
    Eigen::Isometry3d T_map_base_;
    Eigen::Isometry3d
        T_map_camera_;  ///< for a frame without its own camera pose, if the camera is on no link
    DepthFilter filter_;
    std::optional<DepthDenoiser> denoiser_;
    std::optional<Eigen::Isometry3d> T_map_camera_before_;  ///< of the last frame that was kept
    DepthIntegrator integrator_;
    EndMemory ends_;
    std::vector<PosedCapsule> body_camera_;
    std::optional<CertainPixels> certain_;
    DepthImage raw_;
    SeenImages seen_;
    std::uint64_t robot_pixels_ = 0;
    DepthPixelCounts pixels_;
    WrongSize wrong_size_;
};

}  // namespace octoskin
