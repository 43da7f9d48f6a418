#include "host/core/body_fit/excess_field.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/body_fit/bounding_box.hpp"
#include "host/core/body_fit/grid_flood.hpp"
#include "host/core/body_fit/row_cut.hpp"

namespace octoskin {
namespace {

constexpr double kVoxelsOfField = 25'000.0;
constexpr double kMarginMin_m = 0.012;
constexpr double kMarginMax_m = 0.045;
constexpr double kMarginShare = 0.3;  ///< of the box's diagonal
constexpr float kWeightInside = 0.02F;
constexpr float kWeightBeyond = 25.0F;  ///< of the space outside the grid
constexpr double kNear_m = 0.012;
constexpr double kFarthest_m = 0.10;

}  // namespace

ExcessField::ExcessField(const SurfaceMesh& mesh, const MeshDistance& distance, const ConvexHull* hull) {
    Eigen::AlignedBox3d box = box_of(mesh);
    const double margin_m = std::clamp(kMarginShare * box.diagonal().norm(), kMarginMin_m, kMarginMax_m);
    box.min().array() -= margin_m;
    box.max().array() += margin_m;
    side_m_ = std::cbrt(box.volume() / kVoxelsOfField);
    origin_m_ = box.min();
    size_ = (box.sizes() / side_m_).array().ceil().cast<int>().max(1);
    weights_.resize(row_start(0, size_.z()));
    std::vector<float> distances_m(weights_.size());
    for_each_voxel([&](std::size_t voxel, const Eigen::Vector3d& point) {
        distances_m[voxel] = static_cast<float>(distance(point, kFarthest_m));
    });
    const auto width = static_cast<std::size_t>(size_.x());
    RowInterval in_hull;
    const auto wall_m = static_cast<float>(0.6 * side_m_);
    // The margin connects all of the border.
    const std::vector<bool> is_outside =
        reached_from_corner(size_, [&](std::size_t voxel) { return distances_m[voxel] < wall_m; });
    for_each_voxel([&](std::size_t voxel, const Eigen::Vector3d& point) {
        if (hull != nullptr && voxel % width == 0) in_hull = hull->row(point.y(), point.z());
        float& weight = weights_[voxel];
        weight = kWeightInside;
        if (!is_outside[voxel]) return;
        const double beyond = std::max(0.0, static_cast<double>(distances_m[voxel]) - kNear_m) / kNear_m;
        weight += static_cast<float>(beyond * beyond);
        const bool is_in_hull = point.x() > in_hull.from && point.x() < in_hull.to;
        if (!is_in_hull) weight += 1.0F;
    });
    take_out({});
}

template <typename Use>
void ExcessField::for_each_voxel(Use&& use) const {
    for (int z = 0; z < size_.z(); ++z) {
        for (int y = 0; y < size_.y(); ++y) {
            for (int x = 0; x < size_.x(); ++x) {
                const Eigen::Vector3d centre = Eigen::Vector3d(x, y, z).array() + 0.5;
                use(row_start(y, z) + static_cast<std::size_t>(x),
                    Eigen::Vector3d(origin_m_ + side_m_ * centre));
            }
        }
    }
}

template <typename Use>
void ExcessField::for_each_row(const PosedCapsule& capsule, Use&& use) const {
    const PosedCapsule scaled{(capsule.p_a - origin_m_) / side_m_, (capsule.p_b - origin_m_) / side_m_,
                              capsule.radius_m / side_m_};
    const RowCut cut(scaled);
    const Eigen::Vector3d low = scaled.p_a.cwiseMin(scaled.p_b).array() - scaled.radius_m;
    const Eigen::Vector3d high = scaled.p_a.cwiseMax(scaled.p_b).array() + scaled.radius_m;
    const auto first = [&](int axis) {
        return static_cast<int>(std::ceil(std::clamp(low[axis] - 0.5, 0.0, 1.0 * size_[axis])));
    };
    const auto last = [&](int axis) {
        return static_cast<int>(std::floor(std::clamp(high[axis] - 0.5, -1.0, size_[axis] - 1.0)));
    };
    for (int z = first(2); z <= last(2); ++z) {
        for (int y = first(1); y <= last(1); ++y) {
            const RowInterval interval = cut(y + 0.5, z + 0.5);
            const double from = std::clamp(interval.from, 0.0, 1.0 * size_.x());
            const double to = std::clamp(interval.to, 0.0, 1.0 * size_.x());
            if (!interval.is_empty()) use(Row{y, z, from, to});
        }
    }
}

void ExcessField::take_out(std::span<const PosedCapsule> taken) {
    std::vector<float> left = weights_;
    for (const PosedCapsule& capsule : taken) {
        for_each_row(capsule, [&](const Row& row) {
            const auto first = static_cast<std::size_t>(std::ceil(std::max(0.0, row.from - 0.5)));
            for (std::size_t x = first; static_cast<double>(x) + 0.5 < row.to; ++x)
                left[row_start(row.y, row.z) + x] = 0.0F;
        });
    }
    const auto width = static_cast<std::size_t>(size_.x());
    sums_.resize(static_cast<std::size_t>(size_.y() * size_.z()) * (width + 1));
    for (std::size_t row = 0; row < static_cast<std::size_t>(size_.y() * size_.z()); ++row) {
        float sum = 0.0F;
        for (std::size_t x = 0; x < width; ++x) {
            sums_[row * (width + 1) + x] = sum;
            sum += left[row * width + x];
        }
        sums_[row * (width + 1) + width] = sum;
    }
}

double ExcessField::excess(const PosedCapsule& capsule) const {
    const auto width = static_cast<std::size_t>(size_.x());
    double sum = 0.0;
    double inside = 0.0;
    for_each_row(capsule, [&](const Row& row) {
        const float* const sums = &sums_[static_cast<std::size_t>(row.z * size_.y() + row.y) * (width + 1)];
        const auto at = [&](double x) {
            const auto whole = std::min(static_cast<std::size_t>(x), width - 1);
            const double share = x - static_cast<double>(whole);
            return (1.0 - share) * static_cast<double>(sums[whole]) +
                   share * static_cast<double>(sums[whole + 1]);
        };
        sum += at(row.to) - at(row.from);
        inside += row.to - row.from;
    });
    const double radius = capsule.radius_m / side_m_;
    const double length = (capsule.p_b - capsule.p_a).norm() / side_m_;
    const double whole = M_PI * radius * radius * (length + 4.0 / 3.0 * radius);
    return sum + static_cast<double>(kWeightBeyond) * std::max(0.0, whole * 0.98 - inside);
}

}  // namespace octoskin
