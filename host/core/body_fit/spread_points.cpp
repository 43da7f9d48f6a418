#include "host/core/body_fit/spread_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace octoskin {
namespace {

/// Keeps the first point of each cube.
class Cubes {
  public:
    explicit Cubes(double side_m) : side_m_(side_m) {}

    void add(const Eigen::Vector3d& point) {
        constexpr std::int64_t kStride = 2'000'003;
        std::int64_t key = 0;
        for (int axis = 0; axis < 3; ++axis)
            key = key * kStride + static_cast<std::int64_t>(std::floor(point[axis] / side_m_));
        if (keys_.insert(key).second) points.push_back(point);
    }

    std::vector<Eigen::Vector3d> points;

  private:
    double side_m_;
    std::unordered_set<std::int64_t> keys_;
};

}  // namespace

std::vector<Eigen::Vector3d> spread_points(const SurfaceMesh& mesh, double spacing_m, FitWork* work) {
    Cubes cubes(spacing_m);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto [a, b, c] = mesh.corners(i);
        for (const Eigen::Vector3d& corner : {a, b, c}) cubes.add(corner);
        const double longest_m = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
        const int steps = std::max(1, static_cast<int>(std::ceil(longest_m / spacing_m)));
        if (work != nullptr &&
            !work->spend(static_cast<std::uint64_t>(steps + 2) * static_cast<std::uint64_t>(steps + 1) / 2))
            break;
        for (int along_b = 0; along_b <= steps; ++along_b) {
            for (int along_c = 0; along_b + along_c <= steps; ++along_c)
                cubes.add(a + static_cast<double>(along_b) / steps * (b - a) +
                          static_cast<double>(along_c) / steps * (c - a));
        }
    }
    return std::move(cubes.points);
}

}  // namespace octoskin
