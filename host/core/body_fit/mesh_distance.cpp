#include "host/core/body_fit/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace octoskin {
namespace {

constexpr std::uint32_t kLeafMax = 6;

}  // namespace

double distance_to_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
    const Eigen::Vector3d ab = b - a;
    const Eigen::Vector3d ac = c - a;
    const Eigen::Vector3d ap = point - a;
    const double d1 = ab.dot(ap);
    const double d2 = ac.dot(ap);
    if (d1 <= 0.0 && d2 <= 0.0) return ap.norm();
    const Eigen::Vector3d bp = point - b;
    const double d3 = ab.dot(bp);
    const double d4 = ac.dot(bp);
    if (d3 >= 0.0 && d4 <= d3) return bp.norm();
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) return (ap - d1 / (d1 - d3) * ab).norm();
    const Eigen::Vector3d cp = point - c;
    const double d5 = ab.dot(cp);
    const double d6 = ac.dot(cp);
    if (d6 >= 0.0 && d5 <= d6) return cp.norm();
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6) return (ap - d2 / (d2 - d6) * ac).norm();
    const double va = d3 * d6 - d5 * d4;
    const double e1 = d4 - d3;
    const double e2 = d5 - d6;
    if (va <= 0.0 && e1 >= 0.0 && e2 >= 0.0 && e1 + e2 > 0.0) return (bp - e1 / (e1 + e2) * (c - b)).norm();
    const double sum = va + vb + vc;
    if (!(sum > 0.0)) return std::min({ap.norm(), bp.norm(), cp.norm()});  // no area
    return (ap - vb / sum * ab - vc / sum * ac).norm();
}

MeshDistance::MeshDistance(const SurfaceMesh& mesh, FitWork* work) : mesh_(mesh), work_(work) {
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    order_.resize(count);
    std::vector<Eigen::Vector3d> centres(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        order_[i] = i;
        const auto [a, b, c] = mesh.corners(i);
        centres[i] = (a + b + c) / 3.0;
    }
    nodes_.push_back({{}, 0, count});
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const std::uint32_t first = nodes_[i].first;
        const std::uint32_t size = nodes_[i].count;
        Eigen::AlignedBox3d box;
        Eigen::AlignedBox3d box_of_centres;
        for (std::uint32_t k = first; k < first + size; ++k) {
            for (const Eigen::Vector3d& corner : mesh.corners(order_[k])) box.extend(corner);
            box_of_centres.extend(centres[order_[k]]);
        }
        nodes_[i].box = box;
        if (size <= kLeafMax) continue;
        Eigen::Index axis = 0;
        box_of_centres.sizes().maxCoeff(&axis);
        const auto begin = order_.begin() + first;
        std::nth_element(begin, begin + size / 2, begin + size, [&](std::uint32_t left, std::uint32_t right) {
            const double x = centres[left][axis];
            const double y = centres[right][axis];
            return x != y ? x < y : left < right;
        });
        const auto left = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({{}, first, size / 2});
        nodes_.push_back({{}, first + size / 2, size - size / 2});
        nodes_[i].first = left;
        nodes_[i].count = 0;
    }
}

double MeshDistance::operator()(const Eigen::Vector3d& point, double max_m) const {
    double best = max_m;
    if (work_ != nullptr && work_->is_spent()) return best;
    std::uint64_t steps = 0;
    std::array<std::uint32_t, 64> stack{};  // halved in each level: at most 32 levels
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const Node& node = nodes_[stack[--depth]];
        steps += 1 + node.count;
        if (node.box.squaredExteriorDistance(point) >= best * best) continue;
        if (node.count > 0) {
            for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
                const auto [a, b, c] = mesh_.corners(order_[k]);
                best = std::min(best, distance_to_triangle(point, a, b, c));
            }
            continue;
        }
        const bool is_left_nearer = nodes_[node.first].box.squaredExteriorDistance(point) <
                                    nodes_[node.first + 1].box.squaredExteriorDistance(point);
        stack[depth++] = node.first + (is_left_nearer ? 1 : 0);
        stack[depth++] = node.first + (is_left_nearer ? 0 : 1);
    }
    if (work_ != nullptr) work_->spend(steps);
    return best;
}

}  // namespace octoskin
