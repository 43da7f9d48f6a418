#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "host/lab/evaluation/marked_voxels.hpp"
#include "host/lab/evaluation/seen.hpp"

namespace octoskin::evaluation {
namespace {

constexpr double kTilt_rad = 35.0 / 180.0 * std::numbers::pi;

std::optional<double> ratio(std::uint64_t part, std::uint64_t whole) {
    if (whole == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(whole);
}

/// The region, and what the spheres may overlap beside it.
KeyBox box_of_tests(const SeenTruth& truth) {
    const double reach_m = 2.0 * kBodyRadii_m.back() - kBodyOverlap_m;
    return truth.region().padded(static_cast<std::uint16_t>(std::ceil(reach_m / truth.resolution_m)));
}

VoxelGrid<Occupancy> states_of(const FusedMap& map, const KeyBox& box) {
    VoxelGrid<Occupancy> states(box);
    for (std::size_t i = 0; i < states.size(); ++i) states[i] = map.occupancy(box.key_at(i));
    return states;
}

/// The map's voxels, and spheres over them.
class States {
  public:
    States(const FusedMap& map, const SeenTruth& truth)
        : lattice_(truth.resolution_m), states_(states_of(map, box_of_tests(truth))) {}

    [[nodiscard]] Occupancy at(VoxelKey key) const { return states_.at(key); }

    /// All voxels that the sphere overlaps are free. False if it reaches out of the map.
    [[nodiscard]] bool is_free(const Eigen::Vector3d& p_map, double radius_m) const {
        const auto low = lattice_.key_of(p_map.array() - radius_m);
        const auto high = lattice_.key_of(p_map.array() + radius_m);
        if (!low || !high) return false;
        const auto gap_squared = [&](double centre_m, std::uint32_t key) {
            const double off_m = std::abs(lattice_.centre_of(static_cast<std::uint16_t>(key)) - centre_m);
            const double gap_m = std::max(0.0, off_m - lattice_.resolution_m() / 2.0);
            return gap_m * gap_m;
        };
        for (std::uint32_t z = low->z; z <= high->z; ++z) {
            const double of_z = gap_squared(p_map.z(), z);
            for (std::uint32_t y = low->y; y <= high->y; ++y) {
                const double of_yz = of_z + gap_squared(p_map.y(), y);
                for (std::uint32_t x = low->x; x <= high->x; ++x) {
                    if (of_yz + gap_squared(p_map.x(), x) >= radius_m * radius_m) continue;
                    if (states_.at({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                    static_cast<std::uint16_t>(z)}) != Occupancy::free)
                        return false;
                }
            }
        }
        return true;
    }

  private:
    VoxelLattice lattice_;
    VoxelGrid<Occupancy> states_;
};

BodyTests body_tests(const States& states, const SeenVoxel& voxel, double radius_m) {
    BodyTests tests;
    for (const Eigen::Vector3d& p_map : body_centres(voxel, radius_m)) {
        tests.spheres += 1;
        tests.free += states.is_free(p_map, radius_m) ? 1U : 0U;
    }
    return tests;
}

SeenShares shares_of(const States& states, const SeenVoxel& voxel) {
    const Occupancy state = states.at(voxel.key);
    return {.voxels = 1,
            .occupied = state == Occupancy::occupied ? 1U : 0U,
            .free = state == Occupancy::free ? 1U : 0U,
            .unknown = state == Occupancy::unknown ? 1U : 0U,
            .body_2cm = body_tests(states, voxel, kBodyRadii_m[0]),
            .body_5cm = body_tests(states, voxel, kBodyRadii_m[1])};
}

void add_seen_voxels(SeenMetrics& metrics, const States& states, const SeenTruth& truth) {
    for (const SeenVoxel& voxel : truth.voxels) {
        const SeenShares shares = shares_of(states, voxel);
        metrics.all.add(shares);
        (voxel.is_resolved ? metrics.by_class[static_cast<std::size_t>(voxel.thickness)] : metrics.too_coarse)
            .add(shares);
    }
    metrics.seen_occupied = metrics.all.occupied_share();
    metrics.seen_free = metrics.all.free_share();
    metrics.seen_unknown = metrics.all.unknown_share();
    metrics.body_2cm = metrics.all.body_2cm.free_share();
    metrics.body_5cm = metrics.all.body_5cm.free_share();
}

void add_precision(SeenMetrics& metrics, const States& states, const SeenTruth& truth) {
    MarkedVoxels marked;
    for (std::size_t i = 0; i < truth.surface.size(); ++i)
        marked.add(states.at(truth.region().key_at(i)), truth.surface[i]);
    metrics.precision = marked.precision();
    metrics.precision_tolerant = marked.precision_tolerant();
}

/// 0 if nothing seen is occupied, as the plain F1.
std::optional<double> f1(std::optional<double> precision, std::optional<double> recall) {
    if (!recall) return std::nullopt;
    if (!precision || *precision + *recall <= 0.0) return 0.0;
    return 2.0 * *precision * *recall / (*precision + *recall);
}

void add_availability(SeenMetrics& metrics, const States& states, const SeenTruth& truth) {
    for (const Eigen::Vector3d& p_map : truth.p_map_clear_spheres) {
        metrics.clear_spheres += 1;
        metrics.clear_spheres_free += states.is_free(p_map, kClearRadius_m) ? 1U : 0U;
    }
    metrics.availability_5cm = ratio(metrics.clear_spheres_free, metrics.clear_spheres);
}

}  // namespace

std::array<Eigen::Vector3d, 4> body_centres(const SeenVoxel& voxel, double radius_m) {
    const Eigen::Vector3d& axis = voxel.outwards_map;
    const Eigen::Vector3d towards = voxel.to_camera_map - axis.dot(voxel.to_camera_map) * axis;
    constexpr double kAligned = 1e-6;  // the camera is along the axis: any direction across will do
    const Eigen::Vector3d first = towards.norm() > kAligned ? towards.normalized() : axis.unitOrthogonal();
    const double distance_m = radius_m - kBodyOverlap_m;
    std::array<Eigen::Vector3d, 4> centres{voxel.p_map_point + distance_m * axis};
    for (int i = 0; i < 3; ++i) {
        const Eigen::AngleAxisd turn(2.0 * std::numbers::pi * i / 3.0, axis);
        const Eigen::Vector3d direction = std::cos(kTilt_rad) * axis + std::sin(kTilt_rad) * (turn * first);
        centres[static_cast<std::size_t>(i) + 1] = voxel.p_map_point + distance_m * direction;
    }
    return centres;
}

std::optional<double> BodyTests::free_share() const noexcept {
    return ratio(free, spheres);
}
std::optional<double> SeenShares::occupied_share() const noexcept {
    return ratio(occupied, voxels);
}
std::optional<double> SeenShares::free_share() const noexcept {
    return ratio(free, voxels);
}
std::optional<double> SeenShares::unknown_share() const noexcept {
    return ratio(unknown, voxels);
}

void SeenShares::add(const SeenShares& other) noexcept {
    voxels += other.voxels;
    occupied += other.occupied;
    free += other.free;
    unknown += other.unknown;
    body_2cm.spheres += other.body_2cm.spheres;
    body_2cm.free += other.body_2cm.free;
    body_5cm.spheres += other.body_5cm.spheres;
    body_5cm.free += other.body_5cm.free;
}

SeenMetrics seen_metrics(const FusedMap& map, const SeenTruth& truth) {
    assert(map.resolution_m() == truth.resolution_m);
    const States states(map, truth);
    SeenMetrics metrics;
    add_seen_voxels(metrics, states, truth);
    add_precision(metrics, states, truth);
    metrics.f1_seen = f1(metrics.precision, metrics.seen_occupied);
    metrics.f1_noise_free = truth.f1_noise_free;
    add_availability(metrics, states, truth);
    return metrics;
}

}  // namespace octoskin::evaluation
