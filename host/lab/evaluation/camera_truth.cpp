#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "host/core/voxels/ray_walk.hpp"
#include "host/core/voxels/voxel_lattice.hpp"
#include "host/lab/evaluation/truth.hpp"

namespace octoskin::evaluation {
namespace {

constexpr std::uint8_t kPassed = 1;
constexpr std::uint8_t kHit = 2;

/// A view in the map frame, in the single precision in which OctoMap takes points.
struct MapView {
    Eigen::Vector3f origin;
    std::vector<Eigen::Vector3f> points;
};

MapView moved(const DepthView& view, const Eigen::Isometry3d& T_map_base) {
    MapView moved{(T_map_base * view.p_base_camera).cast<float>(), {}};
    moved.points.reserve(view.p_base_points.size());
    for (const auto& p_base : view.p_base_points) {
        moved.points.emplace_back((T_map_base * p_base.cast<double>()).cast<float>());
    }
    return moved;
}

/// The smallest box that holds the camera and all its points, or empty if the octree does not.
std::optional<KeyBox> box_around(const MapView& view, const VoxelLattice& lattice) {
    Eigen::AlignedBox3f bounds(view.origin);
    for (const auto& point : view.points) {
        bounds.extend(point);
    }
    const auto min = lattice.key_of(Eigen::Vector3d(bounds.min().cast<double>()));
    const auto max = lattice.key_of(Eigen::Vector3d(bounds.max().cast<double>()));
    if (!min || !max) {
        return std::nullopt;
    }
    return KeyBox{*min, *max};
}

/// The result of one view for each voxel near it: kPassed, kHit, both or neither.
VoxelGrid<std::uint8_t> mark_rays(const MapView& view, const KeyBox& box, const VoxelLattice& lattice) {
    // A ray may leave the box of its two ends by one voxel (see `Ray::steps_max`).
    VoxelGrid<std::uint8_t> marks(box.padded(1));
    const auto [nx, ny, nz] = marks.box().shape();
    const std::array<std::ptrdiff_t, 3> stride = {1, static_cast<std::ptrdiff_t>(nx),
                                                  static_cast<std::ptrdiff_t>(nx * ny)};
    for (const auto& point : view.points) {
        const auto ray = plan_ray(lattice, view.origin, point);
        if (!ray) {
            continue;
        }
        const std::size_t last = marks.box().index_of(ray->last);
        walk_ray(*ray,
                 {.first = static_cast<std::ptrdiff_t>(marks.box().index_of(ray->first)),
                  .last = static_cast<std::ptrdiff_t>(last),
                  .stride = stride},
                 [&](std::ptrdiff_t index) { marks[static_cast<std::size_t>(index)] |= kPassed; });
        marks[last] |= kHit;
    }
    return marks;
}

/// Unknown is NaN until the first term.
void apply_marks(const VoxelGrid<std::uint8_t>& marks, const CameraTruthConfig& config,
                 VoxelGrid<float>& log_odds) {
    for (std::size_t i = 0; i < log_odds.size(); ++i) {
        const VoxelKey key = log_odds.box().key_at(i);
        const std::uint8_t mark = marks.box().contains(key) ? marks.at(key) : 0;
        if (mark == 0) {
            continue;
        }
        const float before = std::isnan(log_odds[i]) ? 0.0F : log_odds[i];
        const float term = (mark & kHit) != 0 ? config.hit_log_odds : config.miss_log_odds;
        log_odds[i] = std::clamp(before + term, config.log_odds_min, config.log_odds_max);
    }
}

}  // namespace

VoxelGrid<Occupancy> camera_truth(const Survey& survey, const CameraTruthConfig& config, const KeyBox& region,
                                  double resolution_m, const Eigen::Isometry3d& T_map_base) {
    const VoxelLattice lattice(resolution_m);
    VoxelGrid<float> log_odds(region, std::numeric_limits<float>::quiet_NaN());
    for (const auto& base_view : survey.views) {
        const MapView view = moved(base_view, T_map_base);
        if (const auto box = box_around(view, lattice)) {
            apply_marks(mark_rays(view, *box, lattice), config, log_odds);
        }
    }
    VoxelGrid<Occupancy> truth(region);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (!std::isnan(log_odds[i])) {
            truth[i] = log_odds[i] >= 0.0F ? Occupancy::occupied : Occupancy::free;
        }
    }
    return truth;
}

}  // namespace octoskin::evaluation
