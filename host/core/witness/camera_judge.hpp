// Whether one error of the camera explains what range sensors contradict: a pose in the rig, or a scale of
// its depth, that is not the true one.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/core/witness/range_predictor.hpp"

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

    /// A range against what the image makes one expect of the sensor as mounted.
    struct Compared {
        double off_m = 0.0;    ///< the range less the prediction
        double sigma_m = 0.0;  ///< of that
        bool is_from_behind = false;
    };
    /// `hits`: where the sensor's rays meet what the camera sees. What is off by over 15 cm is of something
    /// else and not used. About 1 us.
    void compare(std::uint16_t sensor, const Compared& compared, std::span<const PlaneHit> hits);
    /// After all comparisons with one image. About 10 us for 34 sensors.
    void decide();

    /// The camera's error, while at least two sensors speak for one, and all but the one that does so most
    /// by a likelihood ratio of e^4.5.
    [[nodiscard]] const std::optional<CameraError>& error() const noexcept { return error_; }
    /// Sensors that speak for it.
    [[nodiscard]] std::size_t explained() const noexcept { return explained_; }
    /// An error of the camera is so likely that no sensor may be named.
    [[nodiscard]] bool is_suspect() const noexcept { return is_suspect_; }
    /// By how much the camera may have a point in the wrong place (camera coordinates): the displacement that
    /// the other sensors' ranges make likeliest and two deviations of it. About 1 us.
    [[nodiscard]] double may_misplace_m(std::uint16_t sensor, const Eigen::Vector3d& p) const;

    /// Log-likelihood ratio of the likeliest error to none, without the sensor that speaks for it most.
    [[nodiscard]] double evidence() const noexcept { return evidence_; }

  private:
    /// Turn (rad), shift (m), depth scale less 1; then what is the sensor's own: its offset (m), and how much
    /// thicker than expected the walls are that it sees from behind (m).
    static constexpr int kOfCamera = 7;
    static constexpr int kOfSensor = 2;
    static constexpr int kUnknowns = kOfCamera + kOfSensor;
    using CameraVector = Eigen::Matrix<double, kOfCamera, 1>;
    using CameraMatrix = Eigen::Matrix<double, kOfCamera, kOfCamera>;
    using Vector = Eigen::Matrix<double, kUnknowns, 1>;
    using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

    /// Normal equations of one sensor's comparisons.
    struct Sensor {
        Matrix information = Matrix::Zero();
        Vector moment = Vector::Zero();
        double weight = 0.0;  ///< 1/m^2
        double misfit = 0.0;  ///< minus the log-likelihood without any error
        /// The camera's error as all others show it.
        CameraVector of_others = CameraVector::Zero();
        CameraMatrix covariance_of_others = prior_covariance();
    };
    [[nodiscard]] static CameraMatrix prior_covariance();
    /// The same without what is the sensor's own.
    struct OfCamera {
        CameraMatrix information;
        CameraVector moment;
    };
    [[nodiscard]] static std::optional<Vector> change_of_range(std::span<const PlaneHit> hits,
                                                               bool is_from_behind);
    [[nodiscard]] static OfCamera without_own(const Sensor& sensor);

    std::vector<Sensor> sensors_;
    std::optional<CameraError> error_;
    std::size_t explained_ = 0;
    bool is_suspect_ = false;
    double evidence_ = 0.0;
};

}  // namespace octoskin
