#include "tests/bench/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace octoskin::bench {
namespace {

double median_of(const AllFigures& all, const std::string& resolution, const std::string& integrator) {
    const auto& rows = all.at(resolution);
    return rows.contains(integrator) ? quantile(rows.at(integrator).frame_ms, 0.5) : 0.0;
}

}  // namespace

double quantile(std::vector<double> values, double share) {
    assert(!values.empty());
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(share * last))];
}

void print(const AllFigures& all) {
    fmt::print("\n{:<8} {:<10} {:>10} {:>10} {:>10} {:>10} {:>12} {:>12}\n", "m", "", "median ms", "95 % ms",
               "x octomap", "MiB", "voxels", "leaves");
    for (const auto& [resolution, rows] : all) {
        const double octomap_ms = median_of(all, resolution, "octomap");
        for (const auto& [integrator, figures] : rows) {
            const double median_ms = quantile(figures.frame_ms, 0.5);
            fmt::print("{:<8} {:<10} {:>10.2f} {:>10.2f} {:>10.1f} {:>10.1f} {:>12} {:>12}\n", resolution,
                       integrator, median_ms, quantile(figures.frame_ms, 0.95), octomap_ms / median_ms,
                       static_cast<double>(figures.heap_bytes) / (1 << 20), figures.voxels, figures.leaves);
        }
    }
}

bool write_json(const AllFigures& all, const std::filesystem::path& file) {
    nlohmann::json json;
    for (const auto& [resolution, rows] : all) {
        const double octomap_ms = median_of(all, resolution, "octomap");
        for (const auto& [integrator, figures] : rows) {
            const double median_ms = quantile(figures.frame_ms, 0.5);
            json[resolution][integrator] = {{"ms_median", median_ms},
                                            {"ms_p95", quantile(figures.frame_ms, 0.95)},
                                            {"ratio_octomap", octomap_ms / median_ms},
                                            {"heap_bytes", figures.heap_bytes}};
        }
    }
    std::ofstream out(file);
    out << json.dump(2) << "\n";
    return static_cast<bool>(out.flush());
}

}  // namespace octoskin::bench
