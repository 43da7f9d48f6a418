#include "host/core/witness/range_change.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

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
constexpr double kWallM = 0.03;
/// A ray along a surface says nothing of where it meets it.
constexpr double kAlongMin = 0.25;
/// Of a cone's peak so much must be of surfaces that have a plane.
constexpr double kPlaneShareMin = 0.4;

}  // namespace

/// A point p of a ray with direction d lies on the plane n.p + D = 0 that the camera sees, and, with its
/// error, on n.(p + turn x p + shift) + D scale = 0.
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
