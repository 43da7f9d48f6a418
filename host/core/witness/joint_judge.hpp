// Whether one joint that is not where its joint states say explains what range sensors contradict.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/kinematics/joint_twist.hpp"
#include "host/core/witness/error_fit.hpp"
#include "host/core/witness/range_change.hpp"

namespace octoskin {

/// Which joint, and by how much it is further than its joint states say: radians, metres of a prismatic one.
struct JointError {
    std::size_t joint = 0;
    double offset = 0.0;
};

/// CameraJudge's estimate, of one unknown: of each joint alone its offset, by the ranges of all sensors that
/// it carries. Of some 1500 newest comparisons. 0.8 kB a sensor.
class JointJudge {
  public:
    explicit JointJudge(std::size_t sensors) : sensors_(sensors) {}

    /// `twists`: how the sensor moves with each joint, camera coordinates. About 1 us.
    void compare(std::uint16_t sensor, const RangeChange& change, const JointTwists& twists);
    /// After all comparisons with one image. About 10 us for 34 sensors.
    void decide();

    /// The likeliest joint's, while at least two sensors speak for it, and all but the one that does so most
    /// by a likelihood ratio of e^4.5.
    [[nodiscard]] const std::optional<JointError>& error() const noexcept { return error_; }
    /// An error is so likely that no sensor may be named. One unknown takes up less of what is not quite as
    /// predicted than the camera's seven.
    [[nodiscard]] bool is_suspect() const { return evidence_.is_suspect(1.75); }
    /// The likeliest joint, also while it has no error.
    [[nodiscard]] const JointError& likeliest() const noexcept { return likeliest_; }
    /// What is said of that.
    [[nodiscard]] const ErrorEvidence& evidence() const noexcept { return evidence_; }

  private:
    using Fit = ErrorFit<1>;
    std::vector<std::array<Fit, kJointsMax>> sensors_;
    std::optional<JointError> error_;
    JointError likeliest_;
    ErrorEvidence evidence_;
};

}  // namespace octoskin
