#include "host/core/cross_check/range_change.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

/// A larger difference comes from another object.
constexpr double kOffMaxM = 0.15;
/// From this deviation on, a comparison counts as an outlier (Huber).
constexpr double kHuberSigmas = 2.0;
/// Uncertainty of the robot's pose and of the surface in the image.
constexpr double kPoseSigmaM = 0.01;
/// Comparisons close in time and place are not independent: their weight is reduced.
constexpr double kCounts = 0.7;
/// Weight of comparisons with a wall from behind: lower, because the thickness varies from place to place.
constexpr double kCountsFromBehind = 0.2;
constexpr double kWallM = 0.03;
/// A ray nearly parallel to a surface does not determine where it meets the surface.
constexpr double kAlongMin = 0.25;
/// Minimum share of a cone's peak that comes from surfaces with a plane.
constexpr double kPlaneShareMin = 0.4;

}  // namespace

/// A point p of a ray with direction d lies on the plane n.p + D = 0 that the camera sees. With the camera's
/// error, it lies on n.(p + turn x p + shift) + D scale = 0.
std::optional<RangeChange> range_change(const RangeCompared& compared, std::span<const PlaneHit> hits) {
    if (std::abs(compared.off_m) > kOffMaxM) return std::nullopt;
    RangeChange change{.is_from_behind = compared.is_from_behind};
    double share = 0.0;
    for (const PlaneHit& hit : hits) {
        const Eigen::Vector3d& n = hit.plane.normal;
        const double along = n.dot(hit.direction);
        if (std::abs(along) < kAlongMin || (along > 0.0) != compared.is_from_behind) continue;
        Eigen::Matrix<double, RangeChange::kOfCamera, 1> of_camera;
        of_camera << hit.p.cross(n), n, hit.plane.distance_m;
        change.of_camera -= hit.share / along * of_camera;
        share += hit.share;
    }
    if (share < kPlaneShareMin) return std::nullopt;
    change.of_camera /= share;
    change.off_m = compared.off_m + (compared.is_from_behind ? kWallM : 0.0);
    const double sigma_m = std::hypot(compared.sigma_m, kPoseSigmaM);
    const double counts = compared.is_from_behind ? kCountsFromBehind : kCounts;
    change.weight =
        counts * std::min(1.0, kHuberSigmas * sigma_m / std::abs(change.off_m)) / (sigma_m * sigma_m);
    return change;
}

}  // namespace octoskin
