// One depth camera of the simulated rig: its images, one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "hw/rigfile/rig.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/arm/trajectory.hpp"
#include "hw/sim/camera/depth_camera.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// What the cameras see.
struct CameraSurroundings {
    const World& world;
    const Arm& arm;
    const Trajectory& trajectory;
    const Body& body;
    std::function<const World&(SimTime)> world_at;  ///< empty: `world` is stationary
};

/// The seed of the noise of a rig's camera with this index: of the first one the seed itself, so that a rig's
/// only camera has the noise that it always had.
[[nodiscard]] std::uint64_t noise_seed_of(std::uint64_t seed, std::size_t camera) noexcept;

class RigCamera {
  public:
    /// Its images are `1 / rate_hz` apart, two of them before `start`. `around` must outlive this object.
    RigCamera(const CameraSurroundings& around, rig::Camera camera, const DepthNoise& noise,
              std::uint64_t noise_seed, SimTime start);

    /// The capture time of the next image.
    [[nodiscard]] SimTime next() const;
    /// Renders that image. A static camera in a static world casts the world once.
    [[nodiscard]] std::vector<std::uint16_t> take();

    [[nodiscard]] const rig::Camera& camera() const noexcept { return camera_; }
    [[nodiscard]] std::uint32_t frames() const noexcept { return frames_; }

  private:
    [[nodiscard]] bool is_seeing_anew() const noexcept { return around_.world_at || !camera_.link.empty(); }
    /// As if fixed to the base where its link is.
    [[nodiscard]] rig::Camera placed_at(const Eigen::VectorXd& position) const;
    [[nodiscard]] DepthCamera looking_at(SimTime time, const Eigen::VectorXd& position) const;

    const CameraSurroundings& around_;
    rig::Camera camera_;
    DepthNoise noise_;
    std::uint64_t noise_seed_;
    SimTime start_;
    std::optional<DepthCamera> view_;
    std::uint32_t frames_ = 0;
};

}  // namespace octoskin::sim
