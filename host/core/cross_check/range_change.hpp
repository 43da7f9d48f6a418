// Difference between a range and its prediction by the camera, and its change with possible errors.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "host/core/cross_check/range_predictor.hpp"
#include "host/core/kinematics/joint_twist.hpp"

namespace octoskin {

/// A range compared with the image's prediction for the sensor as mounted.
struct RangeCompared {
    double off_m = 0.0;    ///< range minus prediction
    double sigma_m = 0.0;  ///< standard deviation of that
    bool is_from_behind = false;
};

/// The same, linearized in the possible errors.
struct RangeChange {
    /// Unknowns of a camera: turn (rad), shift (m), depth scale minus 1.
    static constexpr int kOfCamera = 7;
    Eigen::Matrix<double, kOfCamera, 1> of_camera = Eigen::Matrix<double, kOfCamera, 1>::Zero();
    double off_m = 0.0;   ///< difference to be explained
    double weight = 0.0;  ///< 1/m^2
    bool is_from_behind = false;

    /// Change of the range with a joint's offset: metres per radian (per metre for a prismatic joint) by
    /// which the joint is further than its joint states. `twist`: of that joint, camera coordinates. A joint
    /// moves the sensor and its rays, which is equivalent to the opposite motion of the surfaces.
    [[nodiscard]] double of_joint(const JointTwist& twist) const {
        return of_camera.head<3>().dot(twist.turn) + of_camera.segment<3>(3).dot(twist.shift);
    }
};

/// `hits`: where the sensor's rays meet surfaces that the camera sees. Empty if the difference is over 15 cm,
/// which comes from another object, or if too little of the signal comes from planes. About 0.2 us.
[[nodiscard]] std::optional<RangeChange> range_change(const RangeCompared& compared,
                                                      std::span<const PlaneHit> hits);

}  // namespace octoskin
