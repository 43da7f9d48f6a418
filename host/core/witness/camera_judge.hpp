// Whether one error of the camera explains what range sensors contradict: a pose in the rig, or a scale of
// its depth, that is not the true one.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/witness/error_fit.hpp"
#include "host/core/witness/range_change.hpp"

namespace octoskin {

/// How the camera is off. Turns are about its own axes: x to the right, y down, z ahead.
struct CameraError {
    Eigen::Vector3d turn_deg = Eigen::Vector3d::Zero();  ///< from where the rig has it to where it is
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();   ///< the same, along its axes
    double depth_scale = 1.0;                            ///< a true depth is that of the image times this
};

/// A weighted least-squares estimate of the camera's error from all newest ranges, with a prior, and the
/// likelihood ratio of that error to none. Each sensor has an unknown offset of its own (1 cm), and, of walls
/// that the camera sees from the other side, an unknown thickness: neither moves the camera. Of some 1500
/// newest comparisons. 0.5 kB a sensor.
class CameraJudge {
  public:
    explicit CameraJudge(std::size_t sensors);

    /// About 1 us.
    void compare(std::uint16_t sensor, const RangeChange& change);
    /// After all comparisons with one image. About 10 us for 34 sensors.
    void decide();

    /// The camera's error, while at least two sensors speak for one, and all but the one that does so most
    /// by a likelihood ratio of e^4.5.
    [[nodiscard]] const std::optional<CameraError>& error() const noexcept { return error_; }
    /// The likeliest error, also while it is none.
    [[nodiscard]] const CameraError& likeliest() const noexcept { return likeliest_; }
    /// What is said of that.
    [[nodiscard]] const ErrorEvidence& evidence() const noexcept { return evidence_; }
    /// An error is so likely that no sensor may be named.
    [[nodiscard]] bool is_suspect() const { return evidence_.is_suspect(2.5); }
    /// By how much the camera may have a point in the wrong place (camera coordinates): the displacement that
    /// the other sensors' ranges make likeliest and two deviations of it. About 1 us.
    [[nodiscard]] double may_misplace_m(std::uint16_t sensor, const Eigen::Vector3d& p) const;

  private:
    using Fit = ErrorFit<RangeChange::kOfCamera>;
    using Vector = Fit::Vector;
    using Matrix = Eigen::Matrix<double, RangeChange::kOfCamera, RangeChange::kOfCamera>;

    struct Sensor {
        Fit fit;
        /// The camera's error as all others show it.
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
