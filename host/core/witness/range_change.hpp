// A range against what the camera makes one expect, and by how much that changes with what may be off.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "host/core/kinematics/joint_twist.hpp"
#include "host/core/witness/range_predictor.hpp"

namespace octoskin {

/// A range against what the image makes one expect of the sensor as mounted.
struct RangeCompared {
    double off_m = 0.0;    ///< the range less the prediction
    double sigma_m = 0.0;  ///< of that
    bool is_from_behind = false;
};

/// The same, to the first order in what may be off.
struct RangeChange {
    /// Unknowns of a camera: turn (rad), shift (m), depth scale less 1.
    static constexpr int kOfCamera = 7;
    Eigen::Matrix<double, kOfCamera, 1> of_camera = Eigen::Matrix<double, kOfCamera, 1>::Zero();
    double off_m = 0.0;   ///< to be explained
    double weight = 0.0;  ///< 1/m^2
    bool is_from_behind = false;

    /// By how much it changes with a joint: metres for each radian, or metre, by which what carries the
    /// sensor is further than its joint states say. `twist`: of that joint, camera coordinates. A joint moves
    /// the sensor and its rays; that is as if what they meet moved the other way round.
    [[nodiscard]] double of_joint(const JointTwist& twist) const {
        return of_camera.head<3>().dot(twist.turn) + of_camera.segment<3>(3).dot(twist.shift);
    }
};

/// `hits`: where the sensor's rays meet what the camera sees. Empty for what is off by over 15 cm: that is of
/// something else; and where too little of the signal is of planes. About 0.2 us.
[[nodiscard]] std::optional<RangeChange> range_change(const RangeCompared& compared,
                                                      std::span<const PlaneHit> hits);

}  // namespace octoskin
