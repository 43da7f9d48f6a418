#include "host/core/cross_check/camera_judge.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace octoskin {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
/// Prior standard deviations of the camera's error.
constexpr double kTurnSigmaRad = 3.0 / kDegPerRad;
constexpr double kShiftSigmaM = 0.05;
constexpr double kScaleSigma = 0.02;

/// The linear model does not hold for larger errors.
constexpr double kTurnMaxRad = 10.0 / kDegPerRad;

}  // namespace

CameraJudge::CameraJudge(std::size_t sensors) : sensors_(sensors) {}

void CameraJudge::compare(std::uint16_t number, const RangeChange& change) {
    sensors_[number].fit.add(change.of_camera, change);
    for (Sensor& each : sensors_) each.fit.forget();
}

CameraJudge::Vector CameraJudge::prior_sigmas() {
    Vector sigmas;
    sigmas << Eigen::Vector3d::Constant(kTurnSigmaRad), Eigen::Vector3d::Constant(kShiftSigmaM), kScaleSigma;
    return sigmas;
}

double CameraJudge::may_misplace_m(std::uint16_t number, const Eigen::Vector3d& p) const {
    const Sensor& sensor = sensors_[number];
    Eigen::Matrix<double, 3, RangeChange::kOfCamera> moves;  // turn x p + shift - scale p
    moves << 0.0, p.z(), -p.y(), 1.0, 0.0, 0.0, -p.x(),      //
        -p.z(), 0.0, p.x(), 0.0, 1.0, 0.0, -p.y(),           //
        p.y(), -p.x(), 0.0, 0.0, 0.0, 1.0, -p.z();
    const double variance = (moves * sensor.covariance_of_others * moves.transpose()).trace();
    return (moves * sensor.of_others).norm() + 2.0 * std::sqrt(std::max(0.0, variance));
}

void CameraJudge::decide() {
    std::vector<ErrorShare<RangeChange::kOfCamera>> shares;
    shares.reserve(sensors_.size());
    for (const Sensor& sensor : sensors_) shares.push_back(sensor.fit.without_own());
    ErrorEstimate<RangeChange::kOfCamera> found(shares, prior_sigmas());
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        sensors_[i].covariance_of_others = (found.information - shares[i].information).inverse();
        sensors_[i].of_others = sensors_[i].covariance_of_others * (found.moment - shares[i].moment);
    }
    evidence_ = std::move(found.evidence);
    const Vector& likeliest = found.likeliest;
    const bool is_named = evidence_.is_to_be_named() && likeliest.head<3>().norm() <= kTurnMaxRad;
    // The unknowns move the camera's points to their true places; the camera's own error has the opposite
    // sign.
    likeliest_ = {.turn_deg = -kDegPerRad * likeliest.head<3>(),
                  .shift_m = -likeliest.segment<3>(3),
                  .depth_scale = 1.0 + likeliest[6]};
    if (is_named || (error_ && evidence_.is_to_be_kept())) {
        error_ = likeliest_;
    } else {
        error_.reset();
    }
}

}  // namespace octoskin
