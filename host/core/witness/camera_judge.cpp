#include "host/core/witness/camera_judge.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace octoskin {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
/// What is off by more is of something else.
constexpr double kOffMaxM = 0.15;
/// From here on a comparison counts as of an outlier (Huber).
constexpr double kHuberSigmas = 2.0;
/// Of the robot's pose and the surface that the image gives.
constexpr double kPoseSigmaM = 0.01;
/// Comparisons of one time and place are not independent: they count for less than they say.
constexpr double kCounts = 0.7;
/// Those of a wall from behind for even less: its thickness changes from place to place.
constexpr double kCountsFromBehind = 0.2;
constexpr double kForgotten = 1.0 - 1.0 / 1500.0;
/// A ray along a surface says nothing of where it meets it.
constexpr double kAlongMin = 0.25;
/// Of a cone's peak so much must be of surfaces that have a plane.
constexpr double kPlaneShareMin = 0.4;

/// What may be off before anything is compared.
constexpr double kTurnSigmaRad = 3.0 / kDegPerRad;
constexpr double kShiftSigmaM = 0.05;
constexpr double kScaleSigma = 0.02;
constexpr double kOffsetSigmaM = 0.01;
constexpr double kWallM = 0.03;
constexpr double kWallSigmaM = 0.04;

/// A sensor speaks for an error from this log-likelihood ratio on.
constexpr double kExplainedFrom = 1.0;
constexpr std::size_t kExplainedMin = 2;
constexpr double kNamedFrom = 4.5;
constexpr double kKeptFrom = 3.0;
constexpr double kSuspectFrom = 2.5;
/// By so much an error must move what is predicted, in the mean of squares: less is no fault.
constexpr double kNamedM = 0.006;
constexpr double kSuspectM = 0.006;
/// Errors that are larger are not what this model is true for.
constexpr double kTurnMaxRad = 10.0 / kDegPerRad;

}  // namespace

CameraJudge::CameraJudge(std::size_t sensors) : sensors_(sensors) {}

/// By how much the predicted range changes with each unknown. A point p of a ray with direction d lies on the
/// plane n.p + D = 0 that the camera sees, and, with its error, on n.(p + turn x p + shift) + D scale = 0.
std::optional<CameraJudge::Vector> CameraJudge::change_of_range(std::span<const PlaneHit> hits,
                                                                bool is_from_behind) {
    Vector change = Vector::Zero();
    double share = 0.0;
    for (const PlaneHit& hit : hits) {
        const Eigen::Vector3d& n = hit.plane.normal;
        const double along = n.dot(hit.direction);
        if (std::abs(along) < kAlongMin || (along > 0.0) != is_from_behind) continue;
        CameraVector of_camera;
        of_camera << hit.p.cross(n), n, hit.plane.distance_m;
        change.head<kOfCamera>() -= hit.share / along * of_camera;
        share += hit.share;
    }
    if (share < kPlaneShareMin) return std::nullopt;
    change /= share;
    change[kOfCamera] = 1.0;
    change[kOfCamera + 1] = is_from_behind ? -1.0 : 0.0;
    return change;
}

void CameraJudge::compare(std::uint16_t number, const Compared& compared, std::span<const PlaneHit> hits) {
    if (std::abs(compared.off_m) > kOffMaxM) return;
    const auto change = change_of_range(hits, compared.is_from_behind);
    if (!change) return;
    const double off_m = compared.off_m + (compared.is_from_behind ? kWallM : 0.0);
    const double sigma_m = std::hypot(compared.sigma_m, kPoseSigmaM);
    const double counts = compared.is_from_behind ? kCountsFromBehind : kCounts;
    const double weight =
        counts * std::min(1.0, kHuberSigmas * sigma_m / std::abs(off_m)) / (sigma_m * sigma_m);
    Sensor& sensor = sensors_[number];
    sensor.information += weight * *change * change->transpose();
    sensor.moment += weight * off_m * *change;
    sensor.weight += weight;
    sensor.misfit += 0.5 * weight * off_m * off_m;
    for (Sensor& each : sensors_) {
        each.information *= kForgotten;
        each.moment *= kForgotten;
        each.weight *= kForgotten;
        each.misfit *= kForgotten;
    }
}

/// The sensor's own unknowns, with their prior, taken out of its normal equations (Schur complement).
CameraJudge::OfCamera CameraJudge::without_own(const Sensor& sensor) {
    Eigen::Matrix2d own = sensor.information.bottomRightCorner<kOfSensor, kOfSensor>();
    own.diagonal() += Eigen::Vector2d(std::pow(kOffsetSigmaM, -2.0), std::pow(kWallSigmaM, -2.0));
    const Eigen::Matrix<double, kOfCamera, kOfSensor> shared =
        sensor.information.topRightCorner<kOfCamera, kOfSensor>();
    const Eigen::Matrix<double, kOfCamera, kOfSensor> by_own = shared * own.inverse();
    return {
        .information = sensor.information.topLeftCorner<kOfCamera, kOfCamera>() - by_own * shared.transpose(),
        .moment = sensor.moment.head<kOfCamera>() - by_own * sensor.moment.tail<kOfSensor>()};
}

CameraJudge::CameraMatrix CameraJudge::prior_covariance() {
    CameraVector sigmas;
    sigmas << Eigen::Vector3d::Constant(kTurnSigmaRad), Eigen::Vector3d::Constant(kShiftSigmaM), kScaleSigma;
    return sigmas.cwiseAbs2().asDiagonal();
}

double CameraJudge::may_misplace_m(std::uint16_t number, const Eigen::Vector3d& p) const {
    const Sensor& sensor = sensors_[number];
    Eigen::Matrix<double, 3, kOfCamera> moves;           // turn x p + shift - scale p
    moves << 0.0, p.z(), -p.y(), 1.0, 0.0, 0.0, -p.x(),  //
        -p.z(), 0.0, p.x(), 0.0, 1.0, 0.0, -p.y(),       //
        p.y(), -p.x(), 0.0, 0.0, 0.0, 1.0, -p.z();
    const double variance = (moves * sensor.covariance_of_others * moves.transpose()).trace();
    return (moves * sensor.of_others).norm() + 2.0 * std::sqrt(std::max(0.0, variance));
}

void CameraJudge::decide() {
    std::vector<OfCamera> of_camera;
    of_camera.reserve(sensors_.size());
    OfCamera all{.information = CameraMatrix::Zero(), .moment = CameraVector::Zero()};
    double weight = 0.0;
    for (const Sensor& sensor : sensors_) {
        of_camera.push_back(without_own(sensor));
        all.information += of_camera.back().information;
        all.moment += of_camera.back().moment;
        weight += sensor.weight;
    }
    const CameraMatrix with_prior = all.information + prior_covariance().inverse();
    const CameraVector likeliest = with_prior.ldlt().solve(all.moment);
    const double evidence = 0.5 * likeliest.dot(all.moment);

    double most = 0.0;
    explained_ = 0;
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
        const OfCamera& own = of_camera[i];
        const double explained = likeliest.dot(own.moment) - 0.5 * likeliest.dot(own.information * likeliest);
        most = std::max(most, explained);
        explained_ += explained >= kExplainedFrom ? 1U : 0U;
        sensors_[i].covariance_of_others = (with_prior - own.information).inverse();
        sensors_[i].of_others = sensors_[i].covariance_of_others * (all.moment - own.moment);
    }
    evidence_ = evidence - most;
    const double moved_m =
        weight > 0.0 ? std::sqrt(std::max(0.0, likeliest.dot(all.information * likeliest) / weight)) : 0.0;
    is_suspect_ = evidence_ >= kSuspectFrom && moved_m >= kSuspectM;
    const bool is_named = evidence_ >= kNamedFrom && explained_ >= kExplainedMin && moved_m >= kNamedM &&
                          likeliest.head<3>().norm() <= kTurnMaxRad;
    if (is_named || (error_ && evidence_ >= kKeptFrom)) {
        // The unknowns move points of the camera to where they are; the camera moves the other way round.
        error_ = CameraError{.turn_deg = -kDegPerRad * likeliest.head<3>(),
                             .shift_m = -likeliest.segment<3>(3),
                             .depth_scale = 1.0 + likeliest[6]};
    } else {
        error_.reset();
    }
}

}  // namespace octoskin
