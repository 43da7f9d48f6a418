#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/lab/report/chart.hpp"
#include "host/lab/report/charts.hpp"

namespace octoskin::report {
namespace {

std::uint64_t largest_count(std::span<const evaluation::MapSummary* const> maps) {
    std::uint64_t largest = 1;
    for (const auto* map : maps) {
        for (const auto& bin : map->calibration) {
            largest = std::max(largest, bin.count);
        }
    }
    return largest;
}

}  // namespace

std::string_view css_class_of(std::string_view map) noexcept {
    constexpr std::array<std::string_view, 3> kKnown = {"depth", "proximity", "fused"};
    const auto found = std::ranges::find(kKnown, map);
    return found == kKnown.end() ? "other" : *found;
}

std::string calibration_svg(std::span<const evaluation::MapSummary* const> maps) {
    constexpr double kRadiusMin = 1.5;
    constexpr double kRadiusMax = 9.0;
    Chart chart({.low = 0.0, .high = 1.0, .label = "mean predicted probability", .tick_count = 10},
                {.low = 0.0, .high = 1.04, .label = "share that is surface", .tick_count = 5}, 640.0, 460.0);
    chart.line({{0.0, 0.0}, {1.0, 1.0}}, "ideal");
    const auto largest = static_cast<double>(largest_count(maps));
    for (const auto* map : maps) {
        std::vector<ChartPoint> points;
        for (const auto& bin : map->calibration) {
            if (bin.count > 0) {
                points.push_back({*bin.mean_predicted(), *bin.observed_fraction()});
                const double share = std::log1p(static_cast<double>(bin.count)) / std::log1p(largest);
                chart.dot(points.back(), kRadiusMin + (kRadiusMax - kRadiusMin) * share,
                          css_class_of(map->map));
            }
        }
        chart.line(points, css_class_of(map->map));
    }
    return chart.svg("Reliability diagram: observed share of surface voxels over predicted probability");
}

}  // namespace octoskin::report
