#include "host/lab/evaluation/thickness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

namespace octoskin::evaluation {
namespace {

constexpr double kFlat_m = 1e-4;  ///< thinner: a plane
constexpr double kBoardThickness_m = 0.04;
constexpr double kSmall_m = 0.1;
/// Upper bounds of the rods' classes: half-way between the neighbours' thicknesses, roughly.
constexpr std::array<double, 4> kRodsBelow_m{0.009, 0.018, 0.05, kSmall_m};
/// Cosine of 8 degrees: nearer normals count as one, so that no mesh has more than about 400.
constexpr double kSameDirection = 0.990;
constexpr int kTurns = 90;  ///< of 2 degrees

double width_along(const sim::Solid& solid, const Eigen::Vector3d& direction) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const auto& vertex : solid.vertices) {
        const double along = direction.dot(vertex);
        low = std::min(low, along);
        high = std::max(high, along);
    }
    return high - low;
}

/// Distinct normals of the faces, those of the largest first: they decide for a capsule's long facets rather
/// than for its round ends. A box has its least width along one of them.
std::vector<Eigen::Vector3d> normals_of(const sim::Solid& solid) {
    std::vector<Eigen::Vector3d> areas;
    for (const auto& triangle : solid.triangles) {
        const auto corner = [&](int i) { return solid.vertices[static_cast<std::size_t>(triangle[i])]; };
        areas.emplace_back((corner(1) - corner(0)).cross(corner(2) - corner(0)));
    }
    std::ranges::stable_sort(areas, std::ranges::greater{}, [](const auto& area) { return area.norm(); });
    std::vector<Eigen::Vector3d> normals;
    for (const auto& area : areas) {
        if (!(area.norm() > 0.0)) break;
        const Eigen::Vector3d normal = area.normalized();
        const bool is_known = std::ranges::any_of(normals, [&](const Eigen::Vector3d& known) {
            return std::abs(known.dot(normal)) > kSameDirection;
        });
        if (!is_known) normals.push_back(normal);
    }
    return normals;
}

/// Unit vectors across `axis`: the normals' projections, and every two degrees.
std::vector<Eigen::Vector3d> directions_across(const Eigen::Vector3d& axis,
                                               const std::vector<Eigen::Vector3d>& normals) {
    std::vector<Eigen::Vector3d> across;
    for (const auto& normal : normals) {
        const Eigen::Vector3d projected = normal - axis.dot(normal) * axis;
        if (projected.norm() > 1e-3) across.push_back(projected.normalized());
    }
    const Eigen::Vector3d first = axis.unitOrthogonal();
    for (int i = 0; i < kTurns; ++i) {
        across.emplace_back(Eigen::AngleAxisd(std::numbers::pi * i / kTurns, axis) * first);
    }
    return across;
}

struct Width {
    double width_m = std::numeric_limits<double>::infinity();
    Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
};

Width least_width(const sim::Solid& solid, const std::vector<Eigen::Vector3d>& directions) {
    Width least;
    for (const auto& direction : directions) {
        const double width_m = width_along(solid, direction);
        if (width_m < least.width_m) least = {width_m, direction};
    }
    return least;
}

}  // namespace

std::string_view name_of(ThicknessClass thickness) noexcept {
    switch (thickness) {
        case ThicknessClass::rod_5_8_mm:
            return "rod_5_8_mm";
        case ThicknessClass::rod_10_16_mm:
            return "rod_10_16_mm";
        case ThicknessClass::rod_20_40_mm:
            return "rod_20_40_mm";
        case ThicknessClass::rod_70_90_mm:
            return "rod_70_90_mm";
        case ThicknessClass::board:
            return "board";
        case ThicknessClass::other:
            break;
    }
    return "other";
}

std::array<double, 3> extents_of(const sim::Solid& solid) {
    const auto normals = normals_of(solid);
    if (normals.empty()) return {};
    const Width thinnest = least_width(solid, normals);
    const Width across = least_width(solid, directions_across(thinnest.direction, normals));
    const double third_m = width_along(solid, thinnest.direction.cross(across.direction));
    std::array<double, 3> extents{thinnest.width_m, across.width_m, third_m};
    std::ranges::sort(extents);
    return extents;
}

ThicknessClass thickness_class(const std::array<double, 3>& extents_m) noexcept {
    const auto [a, b, c] = extents_m;
    if (a < kFlat_m) return ThicknessClass::other;
    if (a <= kBoardThickness_m && (b >= kSmall_m || b >= 3.0 * a)) return ThicknessClass::board;
    if (b >= 3.0 * a || (c < 2.0 * b && c >= kSmall_m)) return ThicknessClass::other;
    for (std::size_t i = 0; i < kRodsBelow_m.size(); ++i) {
        if (a < kRodsBelow_m[i]) return kEveryThickness[i];
    }
    return ThicknessClass::other;
}

Thickness thickness_of(const sim::Solid& solid) {
    const auto extents = extents_of(solid);
    const bool is_plane = extents[0] < kFlat_m;
    return {thickness_class(extents), is_plane ? std::numeric_limits<double>::infinity() : extents[0]};
}

}  // namespace octoskin::evaluation
