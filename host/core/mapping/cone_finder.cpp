#include "host/core/mapping/cone_finder.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <utility>

namespace octoskin {
namespace {

/// Keys along one axis from first to last; empty if last is less than first.
struct KeySpan {
    int first = 0;
    int last = -1;
};

/// Keys of the voxels in the octree whose centres lie between two coordinates, map frame.
KeySpan keys_between(double low_m, double high_m, double resolution_m) {
    constexpr double kHalf = 0.5;
    const double low = std::ceil(low_m / resolution_m - kHalf);
    const double high = std::floor(high_m / resolution_m - kHalf);
    constexpr double kLowest = -kOriginKey;
    constexpr double kHighest = kOriginKey - 1;
    if (!(low <= high) || low > kHighest || high < kLowest) return {};
    return {static_cast<int>(std::max(low, kLowest)) + kOriginKey,
            static_cast<int>(std::min(high, kHighest)) + kOriginKey};
}

double centre_of(int key, double resolution_m) {
    return (static_cast<double>(key - kOriginKey) + 0.5) * resolution_m;
}

/// A circular cone of infinite length, cut into slices across the axis along which it mostly points.
class SlicedCone {
  public:
    SlicedCone(const Eigen::Vector3d& direction, double tan_angle)
        : cos2_(1.0 / (1.0 + tan_angle * tan_angle)) {
        direction.cwiseAbs().maxCoeff(&along_);
        across_ = (along_ + 1) % 3;
        row_ = (along_ + 2) % 3;
        x_ = direction[along_];
        y_ = direction[across_];
        z_ = direction[row_];
        curve_z_ = z_ * z_ - cos2_;
        curve_y_ = y_ * y_ + curve_z_;
    }

    [[nodiscard]] int along() const { return along_; }
    [[nodiscard]] int across() const { return across_; }
    [[nodiscard]] int row() const { return row_; }

    /// Range of the coordinates `across`, from the apex, in the slice at x (along, from the apex). A point v
    /// is in the cone if (v.d)^2 >= cos^2 |v|^2 and v.d >= 0. The slice is an ellipse if the cone's angle is
    /// less than the angle between the direction and the slice, which is at least 35 degrees.
    [[nodiscard]] std::pair<double, double> across_at(double x) const {
        const double b = x * x_ * y_;
        const double root = std::fabs(x) * std::sqrt(-curve_z_ * (1.0 - cos2_));
        return {(-b + root) / curve_y_, (-b - root) / curve_y_};
    }
    /// Range of the coordinates along the row at (x, y) that lie in the cone; empty (first larger) if none
    /// does.
    [[nodiscard]] std::pair<double, double> row_at(double x, double y) const {
        const double m = x * x_ + y * y_;
        const double b = m * z_;
        const double discriminant = cos2_ * (m * m + curve_z_ * (x * x + y * y));
        if (!(discriminant >= 0.0)) return {1.0, 0.0};
        const double root = std::sqrt(discriminant);
        return {(-b + root) / curve_z_, (-b - root) / curve_z_};
    }

  private:
    double cos2_;
    int along_ = 0;
    int across_ = 1;
    int row_ = 2;
    double x_ = 0.0;  ///< components of the direction along `along`, `across` and `row`
    double y_ = 0.0;
    double z_ = 0.0;
    double curve_z_ = 0.0;  ///< half the second derivatives: negative
    double curve_y_ = 0.0;
};

/// Range of the coordinates along one axis in the part of a ball between two ranges and within an angle of a
/// direction.
std::pair<double, double> extent_of(double direction, double angle_rad, double nearest_m, double furthest_m) {
    const double across = std::sqrt(std::max(0.0, 1.0 - direction * direction));
    const double cos = std::cos(angle_rad);
    const double sin = std::sin(angle_rad);
    const double high = direction >= cos ? 1.0 : direction * cos + across * sin;
    const double low = -direction >= cos ? -1.0 : direction * cos - across * sin;
    return {std::min(low * nearest_m, low * furthest_m), std::max(high * nearest_m, high * furthest_m)};
}

VoxelKey key_at(const std::array<int, 3>& key) {
    return {static_cast<std::uint16_t>(key[0]), static_cast<std::uint16_t>(key[1]),
            static_cast<std::uint16_t>(key[2])};
}

}  // namespace

ConeFinder::ConeFinder(const MappingConfig& config) : config_(config), lattice_(config.map.resolution_m) {}

bool ConeFinder::ends_about(const Beam& beam, VoxelKey key) const noexcept {
    const Eigen::Vector3d v = lattice_.centre_of(key) - beam.p_map_sensor;
    const double half_m = 0.5 * lattice_.resolution_m();
    const double angle_rad = model_of(beam).cap_angle_share * beam.optics.half_angle_rad;
    const double along_m = v.dot(beam.direction_map);
    const double aside_m = (v - along_m * beam.direction_map).norm();
    return std::fabs(v.norm() - *beam.range_m) <= cap_half_m(beam, config_) + half_m &&
           std::atan2(std::max(0.0, aside_m - half_m), along_m) <= angle_rad;
}

std::optional<BeamRejection> ConeFinder::refusal_of(const Beam& beam) const noexcept {
    if (const auto fault = fault_of(beam)) return fault;
    const Eigen::Vector3d end = beam.p_map_sensor + length_m(beam) * beam.direction_map;
    const bool is_inside = lattice_.key_of(beam.p_map_sensor) && lattice_.key_of(end);
    if (!is_inside) return BeamRejection::outside_map;
    return is_cone_too_large(beam, config_) ? std::optional(BeamRejection::cone_too_large) : std::nullopt;
}

Result<const ConeVoxels*, BeamRejection> ConeFinder::find(const Beam& beam, CapWidth width) {
    assert(beam.optics.is_cone());
    if (const auto refusal = refusal_of(beam)) return unexpected(*refusal);
    const ConeModel& model = model_of(beam);
    const double length_m = this->length_m(beam);
    const auto end_key = lattice_.key_of(beam.p_map_sensor + length_m * beam.direction_map);
    voxels_.passed.clear();
    voxels_.cap.clear();
    voxels_.middle.clear();
    const double cap_m = beam.range_m ? cap_half_m(beam, config_) : 0.0;
    const double core_rad = core_angle_rad(beam.optics, config_);
    find_passed(beam, {.end_m = length_m - cap_m,
                       .tan_core = std::tan(core_rad),
                       .margin_m = model.core_margin_voxels * lattice_.resolution_m()});
    if (beam.range_m && length_m <= model.hit_range_max_m) {
        const double marks_rad = width == CapWidth::core ? core_rad : beam.optics.half_angle_rad;
        const double cap_rad = model.cap_angle_share * beam.optics.half_angle_rad;
        find_cap(beam, {.range_m = length_m,
                        .half_thickness_m = cap_m,
                        .angle_rad = cap_rad,
                        .middle_rad =
                            std::min(config_.standing.angle_share * beam.optics.half_angle_rad, marks_rad),
                        .marks_rad = marks_rad});
        const auto has_weight = [](const CapVoxel& voxel) { return voxel.weight > 0.0F; };
        if (std::ranges::none_of(voxels_.cap, has_weight)) {
            std::erase(voxels_.cap, CapVoxel{*end_key, 0.0F});
            voxels_.cap.push_back({*end_key, 1.0F});
        }
        if (voxels_.middle.empty()) voxels_.middle.push_back(*end_key);
    }
    return &voxels_;
}

void ConeFinder::find_passed(const Beam& beam, const Passed& passed) {
    const auto [end_m, tan_core, margin_m] = passed;
    if (!(end_m > 0.0)) return;
    const double resolution_m = lattice_.resolution_m();
    // The cone widened by the margin everywhere is the same cone with its apex further back.
    const Eigen::Vector3d apex = beam.p_map_sensor - margin_m / tan_core * beam.direction_map;
    const SlicedCone cone(beam.direction_map, tan_core);
    const auto [along, across, row] = std::array{cone.along(), cone.across(), cone.row()};
    const Eigen::Vector3d& origin = beam.p_map_sensor;
    const Eigen::Vector3d& direction = beam.direction_map;
    const double width_m =
        (margin_m + end_m * tan_core) * std::sqrt(std::max(0.0, 1.0 - direction[along] * direction[along]));
    const double tip_m = end_m * direction[along];
    const KeySpan slices =
        keys_between(origin[along] + std::max(-end_m, std::min(0.0, tip_m) - width_m),
                     origin[along] + std::min(end_m, std::max(0.0, tip_m) + width_m), resolution_m);
    std::array<int, 3> key{};
    for (int i = slices.first; i <= slices.last; ++i) {
        key[static_cast<std::size_t>(along)] = i;
        const double x = centre_of(i, resolution_m);
        if ((x - apex[along]) * direction[along] < 0.0) continue;
        const auto [y_low, y_high] = cone.across_at(x - apex[along]);
        const KeySpan rows = keys_between(apex[across] + y_low, apex[across] + y_high, resolution_m);
        for (int j = rows.first; j <= rows.last; ++j) {
            key[static_cast<std::size_t>(across)] = j;
            const double y = centre_of(j, resolution_m);
            const auto [z_low, z_high] = cone.row_at(x - apex[along], y - apex[across]);
            const KeySpan cells = keys_between(apex[row] + z_low, apex[row] + z_high, resolution_m);
            const double vx = x - origin[along];
            const double vy = y - origin[across];
            const double depth = vx * direction[along] + vy * direction[across];
            for (int k = cells.first; k <= cells.last; ++k) {
                const double vz = centre_of(k, resolution_m) - origin[row];
                if (depth + vz * direction[row] < 0.0) continue;
                if (!(vx * vx + vy * vy + vz * vz < end_m * end_m)) continue;
                key[static_cast<std::size_t>(row)] = k;
                voxels_.passed.push_back(key_at(key));
            }
        }
    }
}

void ConeFinder::find_cap(const Beam& beam, const Cap& cap) {
    const auto [range_m, half_thickness_m, angle_rad, middle_rad, marks_rad] = cap;
    const double resolution_m = lattice_.resolution_m();
    const double nearest_m = std::max(0.0, range_m - half_thickness_m);
    const double furthest_m = range_m + half_thickness_m;
    const double cos = std::cos(angle_rad);
    const double scale = -0.5 / (beam.optics.sigma_rad * beam.optics.sigma_rad);
    std::array<KeySpan, 3> box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = extent_of(beam.direction_map[axis], angle_rad, nearest_m, furthest_m);
        box[static_cast<std::size_t>(axis)] =
            keys_between(beam.p_map_sensor[axis] + low, beam.p_map_sensor[axis] + high, resolution_m);
    }
    for (int x = box[0].first; x <= box[0].last; ++x) {
        for (int y = box[1].first; y <= box[1].last; ++y) {
            for (int z = box[2].first; z <= box[2].last; ++z) {
                const Eigen::Vector3d v =
                    Eigen::Vector3d(centre_of(x, resolution_m), centre_of(y, resolution_m),
                                    centre_of(z, resolution_m)) -
                    beam.p_map_sensor;
                const double square = v.squaredNorm();
                if (square < nearest_m * nearest_m || square > furthest_m * furthest_m) continue;
                const double depth = v.dot(beam.direction_map);
                const double distance = std::sqrt(square);
                if (depth < cos * distance || distance == 0.0) continue;
                const double off_axis = std::acos(std::min(1.0, depth / distance));
                const VoxelKey key = key_at({x, y, z});
                const double weight = off_axis <= marks_rad ? std::exp(scale * off_axis * off_axis) : 0.0;
                voxels_.cap.push_back({key, static_cast<float>(weight)});
                if (off_axis <= middle_rad && std::fabs(distance - range_m) <= 0.5 * resolution_m)
                    voxels_.middle.push_back(key);
            }
        }
    }
}

}  // namespace octoskin
