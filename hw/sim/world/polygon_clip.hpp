// Clips a polygon to a box.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace octoskin::sim {

/// The part where `value`, linear over the polygon, is not negative. Polygons that share an edge get the same
/// cut point on it.
template <class Point, class Value>
[[nodiscard]] std::vector<Point> clipped(const std::vector<Point>& polygon, const Value& value) {
    std::vector<Point> kept;
    // From the point inside, so that it is the same for both polygons of an edge.
    const auto cut = [&](const Point& within, const Point& beyond) -> Point {
        const double share = value(within) / (value(within) - value(beyond));
        return within + (beyond - within) * share;
    };
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point& here = polygon[i];
        const Point& next = polygon[(i + 1) % polygon.size()];
        const bool is_here = value(here) >= 0.0;
        const bool is_next = value(next) >= 0.0;
        if (is_here) kept.push_back(here);
        if (is_here != is_next) kept.push_back(is_here ? cut(here, next) : cut(next, here));
    }
    return kept;
}

/// `coordinate(point, axis)`: linear over the polygon.
template <class Point, class Coordinate>
[[nodiscard]] std::vector<Point> clipped_to(const Eigen::AlignedBox3d& box, std::vector<Point> polygon,
                                            const Coordinate& coordinate) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        polygon = clipped(polygon, [&](const Point& p) { return coordinate(p, axis) - box.min()[axis]; });
        polygon = clipped(polygon, [&](const Point& p) { return box.max()[axis] - coordinate(p, axis); });
    }
    return polygon;
}

}  // namespace octoskin::sim
