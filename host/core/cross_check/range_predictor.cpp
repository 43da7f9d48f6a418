#include "host/core/cross_check/range_predictor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/kinematics/turned_z.hpp"

namespace octoskin {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
/// Angle of four rays around an ideal ray, which show how its range changes with its direction.
constexpr double kBesideRad = 1.0 * kRadPerDeg;
/// Angle between the rays of a cone.
constexpr double kSpacingRad = 5.0 * kRadPerDeg;
/// The measured peak: the first interval of this length (metres of range) with this fraction of the strongest
/// interval's signal.
constexpr double kPeakWidthM = 0.15;
constexpr double kPeakShare = 0.3;
/// That fraction varies between sensors and scenes. If the peak changes within these limits, there is no
/// prediction.
constexpr double kPeakShareMin = 0.15;
constexpr double kPeakShareMax = 0.5;
constexpr double kSamePeakM = 0.03;
/// If a larger share of the signal may come from unseen space, there is no prediction.
constexpr double kUnseenShareMax = 0.1;
/// Rays with a smaller weight are ignored for the free space.
constexpr double kWeightMin = 0.003;
/// Fraction of the spread of the peak's ranges, and of the distance of the peak from the mean of all.
constexpr double kSpreadShare = 0.25;
/// To count as one surface, at least this share of a peak must come from surfaces with a plane, and these
/// must have one direction within about 10 degrees (length of the mean normal).
constexpr double kPlaneShareMin = 0.4;
constexpr double kOnePlane = 0.985;
/// Fraction of the spread of the ranges of a ray and of those one degree beside it: a mount's angular
/// tolerance.
constexpr double kRayShare = 0.5;

/// `axis` rotated by `angle` towards `turn` about it; turns are the same for every axis of one sensor.
Eigen::Vector3d off_axis(const Eigen::Vector3d& axis, double angle, double turn) {
    return turned_z(axis.normalized()) * Eigen::Vector3d(std::sin(angle) * std::cos(turn),
                                                         std::sin(angle) * std::sin(turn), std::cos(angle));
}

double turn_rad(std::size_t i) {
    return 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(kTurns);
}

}  // namespace

RangePredictor::RangePredictor(const Eigen::Vector3d& direction_sensor, const BeamOptics& optics,
                               const PredictorConfig& config)
    : config_(config), is_cone_(optics.is_cone()) {
    if (!direction_sensor.allFinite()) return;  // no beam is finite then, either
    const double turned_by = kTurnDeg * kRadPerDeg;
    std::array<Eigen::Vector3d, kTurns> turned_axes;
    for (std::size_t i = 0; i < kTurns; ++i)
        turned_axes[i] = off_axis(direction_sensor, turned_by, turn_rad(i));
    if (!optics.is_cone()) {
        rays_sensor_.push_back(direction_sensor);
        for (std::size_t i = 0; i < 4; ++i)
            rays_sensor_.push_back(off_axis(direction_sensor, kBesideRad, 2.0 * turn_rad(i)));
        for (std::size_t i = 0; i < rays_sensor_.size(); ++i) mounted_.push_back({i, 0.2});
        for (std::size_t i = 0; i < kTurns; ++i) {
            turned_[i].push_back({rays_sensor_.size(), 1.0});
            rays_sensor_.push_back(turned_axes[i]);
        }
        return;
    }
    const double reach = optics.half_angle_rad + turned_by;
    const int rows = static_cast<int>(std::ceil(reach / (kSpacingRad * std::sqrt(0.75))));
    rays_sensor_.push_back(off_axis(direction_sensor, 0.0, 0.0));
    for (int row = -rows; row <= rows; ++row) {
        const double y = row * kSpacingRad * std::sqrt(0.75);
        for (int column = -2 * rows; column <= 2 * rows; ++column) {
            const double x = (column + (row % 2 != 0 ? 0.5 : 0.0)) * kSpacingRad;
            const double angle = std::hypot(x, y);
            if (angle > 0.0 && angle <= reach)
                rays_sensor_.push_back(off_axis(direction_sensor, angle, std::atan2(y, x)));
        }
    }
    const auto bundle_about = [&](const Eigen::Vector3d& axis) {
        Bundle bundle;
        double sum = 0.0;
        for (std::size_t i = 0; i < rays_sensor_.size(); ++i) {
            const double angle = std::acos(std::clamp(axis.dot(rays_sensor_[i]), -1.0, 1.0));
            if (angle > optics.half_angle_rad) continue;
            bundle.push_back({i, std::exp(-0.5 * angle * angle / (optics.sigma_rad * optics.sigma_rad))});
            sum += bundle.back().weight;
        }
        for (Weighed& ray : bundle) ray.weight /= sum;
        return bundle;
    };
    mounted_ = bundle_about(direction_sensor);
    for (std::size_t i = 0; i < kTurns; ++i) turned_[i] = bundle_about(turned_axes[i]);
}

/// Standard deviation of the ranges of a bundle's rays that meet a surface.
double RangePredictor::spread_of(const Bundle& bundle, const Followed& rays) {
    double count = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (const Weighed& ray : bundle) {
        const auto& surface_m = rays[ray.ray].reach.surface_m;
        if (!surface_m) continue;
        count += 1.0;
        sum += *surface_m;
        squares += *surface_m * *surface_m;
    }
    if (count == 0.0) return 0.0;
    return std::sqrt(std::max(0.0, squares / count - sum / count * (sum / count)));
}

RangePredictor::Followed RangePredictor::follow(const CameraView& view,
                                                const Eigen::Isometry3d& T_map_sensor) const {
    const Eigen::Isometry3d T_camera_sensor = view.T_camera_map() * T_map_sensor;
    Followed rays;
    rays.reserve(rays_sensor_.size());
    for (const Eigen::Vector3d& ray : rays_sensor_) {
        FollowedRay& followed = rays.emplace_back();
        followed.reach =
            view.reach(T_map_sensor.translation(), T_map_sensor.linear() * ray, config_.range_max_m);
        if (!followed.reach.surface_m) continue;
        const Eigen::Vector3d direction = T_camera_sensor.linear() * ray;
        const Eigen::Vector3d p = T_camera_sensor.translation() + *followed.reach.surface_m * direction;
        if (const auto plane = view.plane_at(p))
            followed.hit = PlaneHit{.p = p, .direction = direction, .plane = *plane, .share = 1.0};
    }
    return rays;
}

/// Hits of the peak; some of a cone's rays meet no plane.
std::vector<PlaneHit> RangePredictor::hits_of(const Echoes& echoes, const Followed& rays) {
    std::vector<PlaneHit> hits;
    double peak = 0.0;
    for (std::size_t i = echoes.peak_begin; i < echoes.peak_end; ++i) peak += echoes.all[i].signal;
    for (std::size_t i = echoes.peak_begin; i < echoes.peak_end; ++i) {
        const auto& hit = rays[echoes.all[i].ray].hit;
        if (!hit) continue;
        hits.push_back(*hit);
        hits.back().share = echoes.all[i].signal / peak;
    }
    return hits;
}

std::optional<SeenSurface> RangePredictor::surface_of(const std::vector<PlaneHit>& hits,
                                                      const CameraView& view) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double share = 0.0;
    for (const PlaneHit& hit : hits) {
        p += hit.share * hit.p;
        normal += hit.share * hit.plane.normal;
        share += hit.share;
    }
    if (share < kPlaneShareMin || normal.norm() < kOnePlane * share) return std::nullopt;
    const Eigen::Isometry3d T_map_camera = view.T_camera_map().inverse();
    return SeenSurface{.p_map = T_map_camera * (p / share),
                       .normal_map = T_map_camera.linear() * normal.normalized()};
}

RangePredictions RangePredictor::predict(const CameraView& view,
                                         const Eigen::Isometry3d& T_map_sensor) const {
    const Followed rays = follow(view, T_map_sensor);
    RangePredictions predictions;
    Echoes echoes;
    predictions.mounted = prediction_of(mounted_, rays, echoes);
    if (predictions.mounted.range_m) {
        if (is_cone_) {
            predictions.hits = hits_of(echoes, rays);
        } else if (const RayReach& axis = rays.front().reach; axis.surface_m) {
            // A single ray determines the range; the rays beside it determine the uncertainty only.
            predictions.mounted.range_m = axis.surface_m;
            predictions.mounted.depth_per_m = axis.depth_per_m;
            predictions.mounted.is_from_behind = axis.is_from_behind;
            predictions.mounted.sigma_m =
                std::hypot(config_.camera_sigma_m / axis.depth_per_m, kRayShare * spread_of(mounted_, rays));
            if (rays.front().hit) predictions.hits = {*rays.front().hit};
        } else {
            predictions.mounted.range_m.reset();
        }
        predictions.mounted.surface = surface_of(predictions.hits, view);
    }
    for (std::size_t i = 0; i < kTurns; ++i) {
        predictions.turned[i] = prediction_of(turned_[i], rays, echoes);
        if (predictions.turned[i].range_m)
            predictions.turned[i].surface = surface_of(hits_of(echoes, rays), view);
    }
    return predictions;
}

RangePrediction RangePredictor::prediction_of(const Bundle& bundle, const Followed& rays,
                                              Echoes& echoes) const {
    RangePrediction prediction{.range_m = {},
                               .sigma_m = 0.0,
                               .hidden_until_m = 0.0,
                               .clear_m = config_.range_max_m,
                               .depth_per_m = 0.0,
                               .is_from_behind = false,
                               .surface = {}};
    if (bundle.empty()) return {};
    echoes.count = 0;
    double unseen_signal = 0.0;
    double signal = 0.0;
    for (const Weighed& ray : bundle) {
        const RayReach& reach = rays[ray.ray].reach;
        const double clear_m = std::max({reach.clear_m, reach.hidden_until_m, 0.05});
        if (ray.weight >= kWeightMin) {
            prediction.hidden_until_m = std::max(prediction.hidden_until_m, reach.hidden_until_m);
            prediction.clear_m = std::min(prediction.clear_m, reach.clear_m);
        }
        if (!reach.surface_m) {
            unseen_signal += ray.weight / (clear_m * clear_m);
            continue;
        }
        if (echoes.count == echoes.all.size()) break;
        const double sigma_m = config_.camera_sigma_m / reach.depth_per_m;
        echoes.all[echoes.count++] = {ray.ray,           *reach.surface_m,  ray.weight / (clear_m * clear_m),
                                      sigma_m * sigma_m, reach.depth_per_m, reach.is_from_behind};
        signal += echoes.all[echoes.count - 1].signal;
    }
    if (echoes.count == 0 || unseen_signal > kUnseenShareMax * (signal + unseen_signal)) return prediction;
    if (!find_peak(echoes)) return prediction;
    double moment = 0.0;
    double square = 0.0;
    double noise = 0.0;
    double peak = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < echoes.count; ++i) {
        const Echo& echo = echoes.all[i];
        all += echo.signal * echo.range_m;
        if (i < echoes.peak_begin || i >= echoes.peak_end) continue;
        peak += echo.signal;
        prediction.depth_per_m += echo.signal * echo.depth_per_m;
        prediction.is_from_behind |= echo.is_from_behind;
        moment += echo.signal * echo.range_m;
        square += echo.signal * echo.range_m * echo.range_m;
        noise += echo.signal * echo.signal * echo.variance;
    }
    const double range_m = moment / peak;
    const double spread_m = std::sqrt(std::max(0.0, square / peak - range_m * range_m));
    const double beyond_m = all / signal - range_m;
    const double share_m = kSpreadShare * std::hypot(spread_m, beyond_m);
    prediction.range_m = range_m;
    prediction.depth_per_m /= peak;
    prediction.sigma_m = std::sqrt(noise / (peak * peak) + share_m * share_m);
    return prediction;
}

/// Finds the first interval with enough signal. False if the result depends on the required fraction, as for
/// a cone that sees a small part of a near object.
bool RangePredictor::find_peak(Echoes& echoes) const {
    const auto begin = echoes.all.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(echoes.count);
    std::sort(begin, end, [](const Echo& a, const Echo& b) { return a.range_m < b.range_m; });
    std::array<double, 128> stretches;
    double strongest = 0.0;
    for (std::size_t i = 0; i < echoes.count; ++i) {
        stretches[i] = 0.0;
        for (std::size_t j = i;
             j < echoes.count && echoes.all[j].range_m <= echoes.all[i].range_m + kPeakWidthM; ++j)
            stretches[i] += echoes.all[j].signal;
        strongest = std::max(strongest, stretches[i]);
    }
    const auto first_with = [&](double share) {
        std::size_t first = 0;
        while (stretches[first] < share * strongest) ++first;
        return first;
    };
    const auto range_at = [&](std::size_t i) { return echoes.all[i].range_m; };
    if (is_cone_ && range_at(first_with(kPeakShareMax)) - range_at(first_with(kPeakShareMin)) > kSamePeakM)
        return false;
    echoes.peak_begin = first_with(kPeakShare);
    echoes.peak_end = echoes.peak_begin;
    while (echoes.peak_end < echoes.count &&
           range_at(echoes.peak_end) <= range_at(echoes.peak_begin) + kPeakWidthM)
        ++echoes.peak_end;
    return true;
}

}  // namespace octoskin
