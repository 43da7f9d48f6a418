// What is off where several sensors contradict the camera: the camera, or a joint of the robot that carries
// the sensors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/witness/camera_judge.hpp"
#include "host/core/witness/joint_judge.hpp"

namespace octoskin {

/// With both one of them is off; which is not known.
struct PoseFault {
    std::optional<CameraError> camera;
    std::optional<JointError> joint;
    std::size_t explained = 0;  ///< sensors that speak for it
};

/// Weighs an error of the camera against that of one joint, by the same comparisons. 2 kB a sensor.
class PoseJudge {
  public:
    explicit PoseJudge(std::size_t sensors) : camera_(sensors), joints_(sensors) {}

    /// `twists`: how the sensor moves with each joint, camera coordinates. About 2 us.
    void compare(std::uint16_t sensor, const RangeChange& change, const JointTwists& twists);
    /// After all comparisons with one image, made at `now`. About 20 us for 34 sensors.
    void decide(HostTime now);

    /// While one of the two judges has an error: that of the one that has explained clearly more for some
    /// seconds, else of both.
    [[nodiscard]] const std::optional<PoseFault>& fault() const noexcept { return fault_; }
    /// An error of the one or the other is so likely that no sensor may be named.
    [[nodiscard]] bool is_suspect() const noexcept { return camera_.is_suspect() || joints_.is_suspect(); }
    [[nodiscard]] const CameraJudge& camera() const noexcept { return camera_; }
    [[nodiscard]] const JointJudge& joints() const noexcept { return joints_; }

  private:
    enum class Leader : std::uint8_t { none, camera, joint };
    [[nodiscard]] Leader leader() const;

    CameraJudge camera_;
    JointJudge joints_;
    Leader leader_ = Leader::none;
    HostTime leads_since_{};
    std::optional<PoseFault> fault_;
};

}  // namespace octoskin
