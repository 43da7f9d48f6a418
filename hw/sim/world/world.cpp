#include "hw/sim/world/world.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "host/io/folder/confined.hpp"
#include "hw/sim/world/ray_caster.hpp"
#include "hw/sim/world/sdf_solids.hpp"
#include "hw/sim/world/triangle_lattice.hpp"

namespace octoskin::sim {
namespace {

/// Distance outside its surface at which a point is tested for another solid that covers it: more than the
/// error of single precision at 100 m, far less than a voxel of a map.
constexpr double kBurialProbe_m = 1e-4;

Eigen::AlignedBox3d bounds_of(const Solid& solid) {
    Eigen::AlignedBox3d bounds;
    for (const auto& vertex : solid.vertices) {
        bounds.extend(vertex);
    }
    return bounds;
}

std::array<Eigen::Vector3d, 3> corners_of(const Solid& solid, const Eigen::Vector3i& triangle) {
    return {solid.vertices[static_cast<std::size_t>(triangle[0])],
            solid.vertices[static_cast<std::size_t>(triangle[1])],
            solid.vertices[static_cast<std::size_t>(triangle[2])]};
}

}  // namespace

struct World::Impl {
    explicit Impl(std::vector<Solid> all) : solids(std::move(all)), caster(solids) {
        for (const auto& solid : solids) {
            bounds.push_back(bounds_of(solid));
        }
    }

    /// Casts rays from `point`: from the inside, a ray meets the back of a triangle first. A ray along an
    /// edge may report the wrong one of two triangles, so the majority of three unrelated directions decides.
    [[nodiscard]] bool is_inside(std::uint32_t solid, const Eigen::Vector3d& point) const {
        static const std::array<Eigen::Vector3d, 3> kDirections = {Eigen::Vector3d(0.5377, 0.1834, 0.8229),
                                                                   Eigen::Vector3d(-0.3188, -0.9077, 0.2731),
                                                                   Eigen::Vector3d(-0.4336, 0.3426, -0.8335)};
        if (!solids[solid].is_closed || !bounds[solid].contains(point)) {
            return false;
        }
        int votes = 0;
        for (const auto& direction : kDirections) {
            const auto hit = caster.cast_at_solid(solid, point, direction);
            votes += hit && hit->normal.dot(direction) > 0.0 ? 1 : 0;
        }
        return votes >= 2;
    }

    [[nodiscard]] bool is_inside_other(std::uint32_t own, const Eigen::Vector3d& point) const {
        for (std::uint32_t i = 0; i < solids.size(); ++i) {
            if (i != own && is_inside(i, point)) {
                return true;
            }
        }
        return false;
    }

    std::vector<Solid> solids;
    std::vector<std::string> warnings;
    std::string written_out;
    std::vector<std::string> meshes;
    std::vector<Eigen::AlignedBox3d> bounds;
    RayCaster caster;
};

World::World(std::vector<Solid> solids, std::vector<std::string> warnings)
    : impl_(std::make_unique<Impl>(std::move(solids))) {
    impl_->warnings = std::move(warnings);
}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World, Error> World::read(const FilePlace& sdf) {
    auto solids = read_solids(confined_to_recording(sdf));
    if (!solids) {
        return unexpected(solids.error());
    }
    World world(std::move(solids->solids), std::move(solids->warnings));
    world.impl_->written_out = std::move(solids->written_out);
    world.impl_->meshes = std::move(solids->meshes);
    return world;
}

const std::string& World::written_out() const noexcept {
    return impl_->written_out;
}

const std::vector<std::string>& World::meshes() const noexcept {
    return impl_->meshes;
}

const std::vector<std::string>& World::warnings() const noexcept {
    return impl_->warnings;
}

const std::vector<Solid>& World::solids() const noexcept {
    return impl_->solids;
}

std::optional<RayHit> World::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double range_max_m) const {
    const auto hit = impl_->caster.cast(origin, direction, range_max_m);
    if (!hit) {
        return std::nullopt;
    }
    return RayHit{hit->t, hit->solid, hit->normal};
}

void World::cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                     std::span<double> t) const {
    impl_->caster.cast_fan(origin, directions, t_max, t);
}

void World::cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                     double range_max_m, std::span<RayHit> hits) const {
    assert(hits.size() == directions.size());
    std::vector<TriangleHit> found(directions.size());
    impl_->caster.cast_fan(origin, directions, range_max_m, found);
    std::transform(found.begin(), found.end(), hits.begin(), [](const TriangleHit& hit) {
        return RayHit{hit.t, hit.solid, hit.normal};
    });
}

void World::sample_surfaces(double pitch_m,
                            const std::function<void(const Eigen::Vector3d&, std::uint32_t)>& visit) const {
    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    sample_surfaces(pitch_m, Eigen::AlignedBox3d(-corner, corner), visit);
}

void World::sample_surfaces(double pitch_m, const Eigen::AlignedBox3d& region,
                            const std::function<void(const Eigen::Vector3d&, std::uint32_t)>& visit) const {
    for (std::uint32_t i = 0; i < impl_->solids.size(); ++i) {
        const Solid& solid = impl_->solids[i];
        for (const auto& triangle : solid.triangles) {
            const auto corners = corners_of(solid, triangle);
            const Eigen::Vector3d probe =
                kBurialProbe_m * (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
            TriangleLattice(corners, pitch_m).for_each_near(region, [&](const Eigen::Vector3d& point) {
                if (region.contains(point) && !impl_->is_inside_other(i, point + probe)) {
                    visit(point, i);
                }
            });
        }
    }
}

double World::samples_within(double pitch_m, const Eigen::AlignedBox3d& region) const {
    double samples = 0.0;
    for (const Solid& solid : impl_->solids) {
        for (const auto& triangle : solid.triangles)
            samples += TriangleLattice(corners_of(solid, triangle), pitch_m).count_near(region);
    }
    return samples;
}

bool World::is_inside(const Eigen::Vector3d& point) const {
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    return impl_->is_inside_other(kNone, point);
}

}  // namespace octoskin::sim
