// Decides what causes the contradictions of several sensors with the camera: the camera, or a joint that
// carries the sensors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/cross_check/camera_judge.hpp"
#include "host/core/cross_check/joint_judge.hpp"

namespace octoskin {

/// If both are set, one of them is wrong, but it is not known which.
struct PoseFault {
    std::optional<CameraError> camera;
    std::optional<JointError> joint;
    std::size_t explained = 0;  ///< number of sensors that support it
};

/// Compares an error of the camera with that of one joint, by the same comparisons. 2 kB a sensor.
class PoseJudge {
  public:
    /// `joints`: of the robot, at most kJointsMax.
    PoseJudge(std::size_t sensors, std::size_t joints) : camera_(sensors), joints_(sensors, joints) {}

    /// `twists`: motion of the sensor with each joint, camera coordinates. About 2 us.
    void compare(std::uint16_t sensor, const RangeChange& change, const JointTwists& twists);
    /// Call after all comparisons with one image, made at `now`. About 20 us for 34 sensors.
    void decide(HostTime now);

    /// Set when one of the two judges has had an error for 3 s: the error of the one that has explained
    /// clearly more for 3 s, otherwise both.
    [[nodiscard]] const std::optional<PoseFault>& fault() const noexcept { return fault_; }
    /// True if an error of either is so likely that no sensor may be reported.
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
    HostTime errs_since_{};
    std::optional<PoseFault> fault_;
};

}  // namespace octoskin
