#include "tests/bench/dense_grid.hpp"

#include <algorithm>

#include "tests/bench/clouds.hpp"

namespace octoskin::bench {
namespace {

// OctoMap's defaults.
constexpr float kHit = 0.85F;
constexpr float kMiss = -0.4F;
constexpr float kLowest = -2.0F;
constexpr float kHighest = 3.5F;
constexpr auto kFurthest_m = static_cast<float>(kRangeMax_m);

}  // namespace

DenseGrid::DenseGrid(const Eigen::AlignedBox3f& box, float resolution_m)
    : lowest_(box.min()),
      resolution_m_(resolution_m),
      size_((box.sizes().array() / resolution_m).ceil().cast<int>() + 1),
      log_odds_(static_cast<std::size_t>(size_.cast<long>().prod()), 0.0F) {}

Eigen::AlignedBox3f DenseGrid::seen(const DepthImage& image, const CameraIntrinsics& camera,
                                    const Eigen::Isometry3d& T_map_camera) {
    double depth_m = 0.0;
    for (const float pixel_m : image.depth_m) depth_m = std::max(depth_m, static_cast<double>(pixel_m));
    depth_m = std::min(depth_m, kRangeMax_m);
    Eigen::AlignedBox3f box(T_map_camera.translation().cast<float>());
    for (const double u : {0.0, static_cast<double>(camera.width)}) {
        for (const double v : {0.0, static_cast<double>(camera.height)}) {
            const Eigen::Vector3d slope((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
            box.extend((T_map_camera * (depth_m * slope)).cast<float>());
        }
    }
    return box;
}

void DenseGrid::insert(const DepthImage& image, const CameraIntrinsics& camera,
                       const Eigen::Isometry3d& T_map_camera) {
    const Eigen::AlignedBox3f box = seen(image, camera, T_map_camera);
    const auto cell_of = [&](const Eigen::Vector3f& point) -> Eigen::Array3i {
        return ((point - lowest_).array() / resolution_m_).floor().cast<int>().max(0).min(size_ - 1);
    };
    const Eigen::Array3i begin = cell_of(box.min());
    const Eigen::Array3i last = cell_of(box.max());
    const Eigen::Isometry3f T_camera_map = T_map_camera.inverse().cast<float>();
    const Eigen::Vector3f step = T_camera_map.linear().col(0) * resolution_m_;
    const auto fx = static_cast<float>(camera.fx);
    const auto fy = static_cast<float>(camera.fy);
    const auto cx = static_cast<float>(camera.cx);
    const auto cy = static_cast<float>(camera.cy);
    const auto width = static_cast<float>(image.width);
    const auto height = static_cast<float>(image.height);
    const float half_m = 0.5F * resolution_m_;
    for (int z = begin.z(); z <= last.z(); ++z) {
        for (int y = begin.y(); y <= last.y(); ++y) {
            const Eigen::Array3f cell(static_cast<float>(begin.x()), static_cast<float>(y),
                                      static_cast<float>(z));
            Eigen::Vector3f p = T_camera_map * (lowest_ + ((cell + 0.5F) * resolution_m_).matrix());
            float* const row = log_odds_.data() +
                               (static_cast<std::ptrdiff_t>(z) * size_.y() + y) * std::ptrdiff_t{size_.x()};
            for (int x = begin.x(); x <= last.x(); ++x, p += step) {
                if (!(p.z() > 0.0F) || p.squaredNorm() > kFurthest_m * kFurthest_m) continue;
                const float u = fx * p.x() / p.z() + cx;
                const float v = fy * p.y() / p.z() + cy;
                if (!(u >= 0.0F && u < width && v >= 0.0F && v < height)) continue;
                const float depth_m =
                    image.depth_m[static_cast<std::size_t>(v) * image.width + static_cast<std::size_t>(u)];
                const float behind_m = p.z() - depth_m;
                if (!(behind_m <= half_m)) continue;  // hidden, or no value
                const float term = behind_m < -half_m ? kMiss : kHit;
                row[x] = std::clamp(row[x] + term, kLowest, kHighest);
            }
        }
    }
}

std::size_t DenseGrid::known() const {
    return log_odds_.size() - static_cast<std::size_t>(std::ranges::count(log_odds_, 0.0F));
}

}  // namespace octoskin::bench
