#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "host/lab/report/chart.hpp"
#include "host/lab/report/charts.hpp"

namespace octoskin::report {
namespace {

// Colours of the style sheet's light theme.
constexpr std::uint32_t kDepth = 0x2b6cb0;
constexpr std::uint32_t kFused = 0x4b7f2b;

/// A chart with the same scale along both axes.
Chart chart_from_above(const evaluation::UnknownSpace& space) {
    constexpr double kSide_px = 420.0;
    const double radius_m = space.region.radius_m;
    return {{.low = -radius_m, .high = radius_m, .label = "x from the base, m", .tick_count = 4},
            {.low = -radius_m, .high = radius_m, .label = "y from the base, m", .tick_count = 4},
            kSide_px + kChartMarginX_px,
            kSide_px + kChartMarginY_px};
}

void paint(Chart& chart, const evaluation::UnknownColumns& columns, std::uint32_t rgb, double max_m) {
    if (columns.side == 0 || !(max_m > 0.0)) return;
    const auto side = static_cast<std::uint32_t>(columns.side);
    Image image{.width = side, .height = side, .rgba = {}};
    image.rgba.reserve(4 * columns.unknown_m.size());
    for (std::size_t row = columns.side; row-- > 0;) {  // a picture's first row is its highest
        for (std::size_t column = 0; column < columns.side; ++column) {
            const double share = columns.unknown_m[row * columns.side + column] / max_m;
            for (const unsigned shift : {16U, 8U, 0U})
                image.rgba.push_back(static_cast<std::uint8_t>(rgb >> shift));
            image.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0 * share)));
        }
    }
    const double length_m = columns.edge_m * static_cast<double>(columns.side);
    chart.image({columns.low_x_m, columns.low_y_m}, {columns.low_x_m + length_m, columns.low_y_m + length_m},
                image);
}

/// Adds the region's edge and the base, and returns the <svg> element.
std::string finished(Chart& chart, std::string_view title, double radius_m) {
    std::vector<ChartPoint> edge;
    constexpr int kCorners = 72;
    for (int i = 0; i <= kCorners; ++i) {
        const double angle = 2.0 * M_PI * i / kCorners;
        edge.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle)});
    }
    chart.line(edge, "ideal");
    chart.dot({0.0, 0.0}, 3.0, "other");
    chart.text({0.0, 0.0}, 6.0, 5.0, "base", "value");
    return chart.svg(title);
}

}  // namespace

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
    return chart.svg("Unknown volume around the robot over time, from depth images alone and fused");
}

double unknown_column_max_m(const evaluation::UnknownSpace& space) noexcept {
    double max_m = 0.0;
    for (const auto* columns :
         {&space.fused_columns, space.depth_columns ? &*space.depth_columns : nullptr}) {
        if (columns == nullptr || columns->unknown_m.empty()) continue;
        max_m = std::max(max_m, *std::ranges::max_element(columns->unknown_m));
    }
    return max_m;
}

std::string depth_columns_svg(const evaluation::UnknownSpace& space) {
    assert(space.depth_columns);
    Chart chart = chart_from_above(space);
    paint(chart, *space.depth_columns, kDepth, unknown_column_max_m(space));
    return finished(chart, "What is unknown from depth images alone, seen from above", space.region.radius_m);
}

std::string fused_columns_svg(const evaluation::UnknownSpace& space, std::size_t count) {
    Chart chart = chart_from_above(space);
    paint(chart, space.fused_columns, kFused, unknown_column_max_m(space));
    for (std::size_t i = 0; i < std::min(count, space.pockets.size()); ++i) {
        const Eigen::Vector3d at = space.pockets[i].centre - space.region.centre;
        chart.text({at.x(), at.y()}, 0.0, 5.0, fmt::format("{}", i + 1), "value", "middle");
    }
    return finished(chart, "What is unknown with range sensors and depth images, seen from above",
                    space.region.radius_m);
}

}  // namespace octoskin::report
