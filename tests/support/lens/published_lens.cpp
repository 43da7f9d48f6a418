#include "tests/support/lens/published_lens.hpp"

#include <cmath>

namespace octoskin::testing_support {

std::array<double, 2> project(const PublishedCamera& camera, double x, double y) {
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    const double r = std::sqrt(x * x + y * y);
    const double radial = 1 + k1 * std::pow(r, 2) + k2 * std::pow(r, 4) + k3 * std::pow(r, 6);
    const double x2 = x * radial + 2 * p1 * x * y + p2 * (std::pow(r, 2) + 2 * x * x);
    const double y2 = y * radial + p1 * (std::pow(r, 2) + 2 * y * y) + 2 * p2 * x * y;
    return {camera.fx * x2 + camera.cx, camera.fy * y2 + camera.cy};
}

std::array<double, 2> unproject(const PublishedCamera& camera, double u, double v) {
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    const double x0 = (u - camera.cx) / camera.fx;
    const double y0 = (v - camera.cy) / camera.fy;
    double x = x0;
    double y = y0;
    for (int round = 0; round < 200; ++round) {
        const double r2 = x * x + y * y;
        const double icdist = 1 / (1 + ((k3 * r2 + k2) * r2 + k1) * r2);
        const double delta_x = 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
        const double delta_y = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
        x = (x0 - delta_x) * icdist;
        y = (y0 - delta_y) * icdist;
    }
    return {x, y};
}

}  // namespace octoskin::testing_support
