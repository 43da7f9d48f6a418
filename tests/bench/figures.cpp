#include "tests/bench/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace octoskin::bench {
namespace {

/// How many times as long the peer takes; empty if it did not run.
std::optional<double> ratio_of(const Figures& figures, const std::map<std::string, Figures>& rows) {
    const auto peer = rows.find(figures.peer);
    if (peer == rows.end()) return std::nullopt;
    return quantile(peer->second.run_ms, 0.5) / quantile(figures.run_ms, 0.5);
}

std::map<std::string, double> medians_of(const std::map<std::string, std::vector<double>>& parts_ms) {
    std::map<std::string, double> medians;
    for (const auto& [name, runs_ms] : parts_ms) medians[name] = quantile(runs_ms, 0.5);
    return medians;
}

nlohmann::json json_of(const Figures& figures, const std::optional<double>& ratio) {
    nlohmann::json json = {{"ms_median", quantile(figures.run_ms, 0.5)},
                           {"ms_p95", quantile(figures.run_ms, 0.95)},
                           {"ratio_octomap", ratio ? nlohmann::json(*ratio) : nlohmann::json()},
                           {"heap_bytes", figures.heap_bytes},
                           {"leaves", figures.leaves},
                           {"voxels", figures.voxels},
                           {"runs", figures.run_ms.size()}};
    if (!figures.parts_ms.empty()) json["parts_ms"] = medians_of(figures.parts_ms);
    return json;
}

}  // namespace

double quantile(std::vector<double> values, double share) {
    assert(!values.empty());
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(share * last))];
}

void print(const AllFigures& all) {
    fmt::print("\n{:<6} {:<32} {:>5} {:>11} {:>11} {:>9} {:>9} {:>11} {:>11}\n", "m", "", "runs", "median ms",
               "95 % ms", "x octomap", "MiB", "voxels", "leaves");
    for (const auto& [resolution, rows] : all) {
        for (const auto& [name, figures] : rows) {
            const auto ratio = ratio_of(figures, rows);
            fmt::print("{:<6} {:<32} {:>5} {:>11.3f} {:>11.3f} {:>9} {:>9.1f} {:>11} {:>11}\n", resolution,
                       name, figures.run_ms.size(), quantile(figures.run_ms, 0.5),
                       quantile(figures.run_ms, 0.95), ratio ? fmt::format("{:.2f}", *ratio) : "",
                       static_cast<double>(figures.heap_bytes) / (1 << 20), figures.voxels, figures.leaves);
            if (figures.parts_ms.empty()) continue;
            fmt::print("{:<6} ", "");
            for (const auto& [part, median_ms] : medians_of(figures.parts_ms))
                fmt::print(" {} {:.3f}", part, median_ms);
            fmt::print(" ms\n");
        }
    }
}

bool write_json(const AllFigures& all, const std::optional<DataSetFrames>& frames,
                const std::filesystem::path& file) {
    nlohmann::json json;
    for (const auto& [resolution, rows] : all) {
        for (const auto& [name, figures] : rows)
            json[resolution][name] = json_of(figures, ratio_of(figures, rows));
    }
    if (frames) {
        json["frames"] = {{"folder", frames->folder},
                          {"width", frames->width},
                          {"height", frames->height},
                          {"mean_depth_m", frames->mean_depth_m}};
    }
    std::ofstream out(file);
    out << json.dump(2) << "\n";
    return static_cast<bool>(out.flush());
}

}  // namespace octoskin::bench
