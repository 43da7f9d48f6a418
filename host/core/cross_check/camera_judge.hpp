// Decides whether one error of the camera (its pose in the rig, or its depth scale) explains the
// contradictions of several range sensors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/cross_check/error_fit.hpp"
#include "host/core/cross_check/range_change.hpp"

namespace octoskin {

/// Error of the camera. Turns are about its own axes: x to the right, y down, z forward.
struct CameraError {
    Eigen::Vector3d turn_deg = Eigen::Vector3d::Zero();  ///< from the pose in the rig to the true pose
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();   ///< the same, along its axes
    double depth_scale = 1.0;                            ///< true depth = depth in the image times this
};

/// A weighted least-squares estimate of the camera's error from the newest ranges of all sensors, with a
/// prior, and the likelihood ratio of that error to none. Each sensor has its own unknown offset (1 cm) and,
/// for walls that the camera sees from the other side, an unknown thickness: neither moves the camera. Uses
/// about the newest 1500 comparisons. 0.5 kB a sensor.
class CameraJudge {
  public:
    explicit CameraJudge(std::size_t sensors);

    /// Adds a comparison. About 1 us.
    void compare(std::uint16_t sensor, const RangeChange& change);
    /// Call after all comparisons with one image. About 10 us for 34 sensors.
    void decide();

    /// The camera's error, while at least two sensors support one, and all sensors except the strongest
    /// supporter support it by a likelihood ratio of e^4.5.
    [[nodiscard]] const std::optional<CameraError>& error() const noexcept { return error_; }
    /// The most likely error, even if it is not significant.
    [[nodiscard]] const CameraError& likeliest() const noexcept { return likeliest_; }
    /// The evidence for the most likely error.
    [[nodiscard]] const ErrorEvidence& evidence() const noexcept { return evidence_; }
    /// True if an error is so likely that no sensor may be reported.
    [[nodiscard]] bool is_suspect() const { return evidence_.is_suspect(2.5); }
    /// By how much the camera may misplace a point (camera coordinates), metres: the most likely displacement
    /// by the other sensors' ranges plus two standard deviations. About 1 us.
    [[nodiscard]] double may_misplace_m(std::uint16_t sensor, const Eigen::Vector3d& p) const;

  private:
    using Fit = ErrorFit<RangeChange::kOfCamera>;
    using Vector = Fit::Vector;
    using Matrix = Eigen::Matrix<double, RangeChange::kOfCamera, RangeChange::kOfCamera>;

    struct Sensor {
        Fit fit;
        /// The camera's error as estimated from all other sensors.
        Vector of_others = Vector::Zero();
        Matrix covariance_of_others = prior_sigmas().cwiseAbs2().asDiagonal();
    };
    [[nodiscard]] static Vector prior_sigmas();

    std::vector<Sensor> sensors_;
    std::optional<CameraError> error_;
    CameraError likeliest_;
    ErrorEvidence evidence_;
};

}  // namespace octoskin
