#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/apps/report/chart.hpp"
#include "host/apps/report/charts.hpp"

namespace octoskin::report {

std::string unknown_curves_svg(const evaluation::UnknownSpace& space) {
    assert(!space.samples.empty());
    std::vector<ChartPoint> depth;
    std::vector<ChartPoint> fused;
    for (const auto& sample : space.samples) {
        if (sample.depth_m3) depth.push_back({sample.t_s, *sample.depth_m3});
        fused.push_back({sample.t_s, sample.fused_m3});
    }
    const double end_s = std::max(space.samples.back().t_s, 0.1);
    Chart chart({.low = 0.0, .high = end_s, .label = "time, s", .tick_count = 10},
                {.low = 0.0, .high = 1.05 * space.region_m3, .label = "unknown, m³", .tick_count = 6});
    if (!depth.empty()) chart.line(depth, "depth");
    chart.line(fused, "fused");
    return chart.svg("Unknown volume around the robot over time, with the camera alone and fused");
}

std::string pockets_svg(const evaluation::UnknownSpace& space, std::size_t count) {
    assert(!space.pockets.empty());
    const double radius_m = space.region.radius_m;
    // One scale along both axes.
    constexpr double kSide_px = 420.0;
    Chart chart({.low = -radius_m, .high = radius_m, .label = "x from the base, m", .tick_count = 4},
                {.low = -radius_m, .high = radius_m, .label = "y from the base, m", .tick_count = 4},
                kSide_px + kChartMarginX_px, kSide_px + kChartMarginY_px);
    std::vector<ChartPoint> edge;
    constexpr int kCorners = 72;
    for (int i = 0; i <= kCorners; ++i) {
        const double angle = 2.0 * M_PI * i / kCorners;
        edge.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle)});
    }
    chart.line(edge, "ideal");
    chart.dot({0.0, 0.0}, 3.0, "other");
    chart.text({0.0, 0.0}, 6.0, 4.0, "base", "tick");
    for (std::size_t i = 0; i < std::min(count, space.pockets.size()); ++i) {
        const auto& pocket = space.pockets[i];
        const Eigen::Vector3d at = pocket.centre - space.region.centre;
        // As large as a ball of that volume.
        const double ball_m = std::cbrt(0.75 / M_PI * pocket.volume_m3);
        chart.dot({at.x(), at.y()}, std::max(2.5, kSide_px * ball_m / (2.0 * radius_m)), "fused");
        chart.text({at.x(), at.y()}, 0.0, 4.0, fmt::format("{}", i + 1), "tick", "middle");
    }
    return chart.svg("The largest unknown pockets, seen from above");
}

}  // namespace octoskin::report
