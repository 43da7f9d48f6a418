#include "host/core/voxels/ray_walk.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>

namespace octoskin {
namespace {

constexpr double kNeverStepped = std::numeric_limits<double>::max();

/// Fills in one axis. The casts are those of OctoMap: a border is in double, but its half edge is in single
/// precision, as is the direction. Without them one voxel in a few million differs.
void plan_axis(Ray& ray, std::size_t axis, const VoxelLattice& lattice, std::uint16_t first_key, float origin,
               float direction) {
    if (!(direction > 0.0F) && !(direction < 0.0F)) {
        ray.sign[axis] = 0;
        ray.t_next[axis] = kNeverStepped;
        ray.t_step[axis] = kNeverStepped;
        return;
    }
    const std::int32_t sign = direction > 0.0F ? 1 : -1;
    const double half_edge_m = static_cast<double>(static_cast<float>(sign * lattice.resolution_m() * 0.5));
    const double border_m = lattice.centre_of(first_key) + half_edge_m;
    ray.sign[axis] = sign;
    ray.t_next[axis] = (border_m - static_cast<double>(origin)) / static_cast<double>(direction);
    ray.t_step[axis] = lattice.resolution_m() / std::fabs(static_cast<double>(direction));
}

}  // namespace

Result<Ray, RayFault> plan_ray(const VoxelLattice& lattice, const Eigen::Vector3f& origin,
                               const Eigen::Vector3f& end) {
    if (!origin.allFinite() || !end.allFinite()) return unexpected(RayFault::not_finite);
    const auto first = lattice.key_of(origin.cast<double>());
    const auto last = lattice.key_of(end.cast<double>());
    if (!first || !last) return unexpected(RayFault::outside_map);

    Ray ray{.first = *first, .last = *last};
    if (*first == *last) return ray;
    const Eigen::Vector3f offset = end - origin;
    const float length_squared = offset.x() * offset.x() + offset.y() * offset.y() + offset.z() * offset.z();
    ray.length_m = static_cast<float>(std::sqrt(static_cast<double>(length_squared)));
    // If two points on either side of a face are so close that the square underflows: the origin's voxel and
    // no step. (OctoMap divides by zero here and walks until an assertion stops it.)
    const Eigen::Vector3f direction =
        ray.length_m > 0.0F ? Eigen::Vector3f(offset / ray.length_m) : Eigen::Vector3f::Zero();
    plan_axis(ray, 0, lattice, first->x, origin.x(), direction.x());
    plan_axis(ray, 1, lattice, first->y, origin.y(), direction.y());
    plan_axis(ray, 2, lattice, first->z, origin.z(), direction.z());
    ray.steps_max =
        std::abs(last->x - first->x) + std::abs(last->y - first->y) + std::abs(last->z - first->z) + 3;
    return ray;
}

}  // namespace octoskin
