#include "host/core/body_fit/fit_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "host/core/body_fit/bounding_box.hpp"
#include "host/core/body_fit/golden_turn.hpp"
#include "host/core/body_fit/grid_flood.hpp"
#include "host/core/body_fit/row_cut.hpp"

namespace octoskin {
namespace {

constexpr double kSpacing_m = 0.004;
/// Of a capsule: on one of over a square metre, the spacing is larger.
constexpr double kPointsMost = 60'000.0;
constexpr double kRows = 8'000.0;
constexpr double kVoxelsAround = 60'000.0;
constexpr double kMeasuredUpTo_m = 1.0;

/// The space around the set that a way leads to from far away.
class Surroundings {
  public:
    explicit Surroundings(std::span<const PosedCapsule> capsules) {
        Eigen::AlignedBox3d box = box_of(capsules);
        side_m_ = std::cbrt(box.volume() / kVoxelsAround);
        box.min().array() -= 2.0 * side_m_;
        box.max().array() += 2.0 * side_m_;
        origin_m_ = box.min();
        size_ = (box.sizes() / side_m_).array().ceil().cast<int>();
        is_closed_.resize(index(0, 0, size_.z()));
        for (const PosedCapsule& capsule : capsules) fill(RowCut(capsule));
        is_reached_ = reached_from_corner(size_, [&](std::size_t voxel) { return is_closed_[voxel]; });
    }

    /// Whether a voxel beside the point is reached.
    [[nodiscard]] bool reach(const Eigen::Vector3d& point) const {
        const Eigen::Vector3i at = ((point - origin_m_) / side_m_).array().floor().cast<int>();
        for (int i = 0; i < 27; ++i) {
            const Eigen::Vector3i near = at + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            if (is_reached_[index(near.x(), near.y(), near.z())]) return true;
        }
        return false;
    }

  private:
    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return static_cast<std::size_t>((z * size_.y() + y) * size_.x() + x);
    }

    void fill(const RowCut& cut) {
        for (int z = 0; z < size_.z(); ++z) {
            for (int y = 0; y < size_.y(); ++y) {
                const RowInterval row =
                    cut(origin_m_.y() + (y + 0.5) * side_m_, origin_m_.z() + (z + 0.5) * side_m_);
                if (row.is_empty()) continue;
                const auto first = static_cast<int>(std::ceil((row.from - origin_m_.x()) / side_m_ - 0.5));
                for (int x = first; origin_m_.x() + (x + 0.5) * side_m_ < row.to; ++x)
                    is_closed_[index(x, y, z)] = true;
            }
        }
    }

    Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
    Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
    double side_m_ = 0.0;
    std::vector<bool> is_closed_;
    std::vector<bool> is_reached_;
};

bool is_in_any(std::span<const PosedCapsule> capsules, const Eigen::Vector3d& point, double within_m) {
    return std::ranges::any_of(capsules, [&](const PosedCapsule& capsule) {
        return distance_to_surface(capsule, point) < within_m;
    });
}

/// Length of the union of `taken` outside `hull`. Sorts `taken`.
double length_outside(std::vector<RowInterval>& taken, const RowInterval& hull) {
    std::ranges::sort(taken, {}, &RowInterval::from);
    double reached = taken.front().from;
    double length = 0.0;
    const auto add = [&](double from, double to) {
        length += std::max(0.0, to - from);
        if (!hull.is_empty()) length -= std::max(0.0, std::min(to, hull.to) - std::max(from, hull.from));
    };
    for (const RowInterval& interval : taken) {
        const double from = std::max(reached, interval.from);
        if (interval.to > from) add(from, interval.to);
        reached = std::max(reached, interval.to);
    }
    return length;
}

/// Volume of the set outside the hull.
double excess_m3(std::span<const PosedCapsule> capsules, const ConvexHull& hull) {
    const Eigen::AlignedBox3d box = box_of(capsules);
    const double side_m = std::sqrt(box.sizes().y() * box.sizes().z() / kRows);
    const auto rows_y = static_cast<int>(std::ceil(box.sizes().y() / side_m));
    const auto rows_z = static_cast<int>(std::ceil(box.sizes().z() / side_m));
    std::vector<RowCut> cuts(capsules.begin(), capsules.end());
    std::vector<RowInterval> taken;
    double length_m = 0.0;
    for (int i = 0; i < rows_y * rows_z; ++i) {
        const double y = box.min().y() + (i % rows_y + 0.5) * side_m;
        const double z = box.min().z() + (i / rows_y + 0.5) * side_m;
        taken.clear();
        for (const RowCut& cut : cuts) {
            const RowInterval interval = cut(y, z);
            if (!interval.is_empty()) taken.push_back(interval);
        }
        if (!taken.empty()) length_m += length_outside(taken, hull.row(y, z));
    }
    return length_m * side_m * side_m;
}

/// Points of one capsule's surface, each for the same area.
template <typename Use>
void for_each_surface_point(const PosedCapsule& capsule, Use&& use) {
    const Eigen::Vector3d axis = capsule.p_b - capsule.p_a;
    const double length_m = axis.norm();
    const Eigen::Vector3d u = length_m > 1e-9 ? Eigen::Vector3d(axis / length_m) : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d v = u.unitOrthogonal();
    const Eigen::Vector3d w = u.cross(v);
    // A ball cut at its equator and moved apart by the axis: equal areas along the height (Archimedes).
    const double height_m = length_m + 2.0 * capsule.radius_m;
    const double area_m2 = 2.0 * std::numbers::pi * capsule.radius_m * height_m;
    const auto count =
        static_cast<int>(std::ceil(std::min(kPointsMost, area_m2 / (kSpacing_m * kSpacing_m))));
    GoldenTurn turn;
    for (int i = 0; i < count; ++i, turn.advance()) {
        const double h = (i + 0.5) / count * height_m - capsule.radius_m;
        const double on_axis = std::clamp(h, 0.0, length_m);
        const double rise = h - on_axis;
        const double across = std::sqrt(std::max(0.0, capsule.radius_m * capsule.radius_m - rise * rise));
        use(capsule.p_a + h * u + across * (turn.cosine() * v + turn.sine() * w), area_m2 / count);
    }
}

}  // namespace

FitMeasures measure(std::span<const PosedCapsule> capsules, const MeshDistance& distance,
                    const ConvexHull* hull) {
    FitMeasures measures;
    if (hull != nullptr) measures.excess_ratio = excess_m3(capsules, *hull) / hull->volume_m3();
    std::vector<std::pair<double, double>> found;  // distance and area
    double area_m2 = 0.0;
    const Surroundings surroundings(capsules);
    for (const PosedCapsule& capsule : capsules) {
        for_each_surface_point(capsule, [&](const Eigen::Vector3d& point, double area) {
            if (is_in_any(capsules, point, -1e-7) || !surroundings.reach(point)) return;
            found.emplace_back(distance(point, kMeasuredUpTo_m), area);
            area_m2 += area;
        });
    }
    std::ranges::sort(found);
    double passed_m2 = 0.0;
    for (const auto& [distance_m, area] : found) {
        passed_m2 += area;
        if (passed_m2 <= 0.95 * area_m2) measures.protrusion_p95_m = distance_m;
        if (passed_m2 <= 0.99 * area_m2) measures.protrusion_p99_m = distance_m;
        measures.protrusion_max_m = distance_m;
    }
    return measures;
}

}  // namespace octoskin
