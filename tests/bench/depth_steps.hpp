// The steps of DepthStage and of the map, one by one, each with its time.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/core/beams/robot_pose.hpp"
#include "host/core/depth/depth_denoiser.hpp"
#include "host/core/depth/depth_filter.hpp"
#include "host/core/mapping/depth_integrator.hpp"
#include "host/core/mapping/end_memory.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin::bench {

class DepthSteps {
  public:
    /// The rig has a camera; its base is the map's origin.
    DepthSteps(const HostRig& rig, const MappingConfig& config);

    /// Throws std::runtime_error if the frame is refused.
    void take(const DepthFrame& frame, const RobotPose& robot);

    [[nodiscard]] const FusedMap& map() const noexcept { return map_; }
    /// CPU time of all threads, milliseconds, of each frame by the step's name.
    [[nodiscard]] const std::map<std::string, std::vector<double>>& times_ms() const noexcept {
        return times_ms_;
    }

  private:
    template <class Step>
    void time(const char* name, const Step& step);
    void remove_arm(DepthImage& image, const RobotPose& robot, const Eigen::Isometry3d& T_map_camera);
    void clean(DepthImage& image, bool is_same_place);

    HostCamera camera_;
    MappingConfig config_;
    double self_margin_m_;
    DepthFilter filter_;
    std::optional<DepthDenoiser> denoiser_;
    DepthIntegrator integrator_;
    EndMemory ends_;
    FusedMap map_;
    std::optional<Eigen::Isometry3d> T_map_camera_before_;
    std::map<std::string, std::vector<double>> times_ms_;
};

}  // namespace octoskin::bench
