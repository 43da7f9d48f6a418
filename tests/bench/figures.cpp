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

}  // namespace

double quantile(std::vector<double> values, double share) {
    assert(!values.empty());
    std::ranges::sort(values);
    const auto last = static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(share * last))];
}

void print(const AllFigures& all) {
    fmt::print("\n{:<6} {:<22} {:>5} {:>11} {:>11} {:>9} {:>9} {:>11} {:>11}\n", "m", "", "runs", "median ms",
               "95 % ms", "x octomap", "MiB", "voxels", "leaves");
    for (const auto& [resolution, rows] : all) {
        for (const auto& [name, figures] : rows) {
            const auto ratio = ratio_of(figures, rows);
            fmt::print("{:<6} {:<22} {:>5} {:>11.3f} {:>11.3f} {:>9} {:>9.1f} {:>11} {:>11}\n", resolution,
                       name, figures.run_ms.size(), quantile(figures.run_ms, 0.5),
                       quantile(figures.run_ms, 0.95), ratio ? fmt::format("{:.2f}", *ratio) : "",
                       static_cast<double>(figures.heap_bytes) / (1 << 20), figures.voxels, figures.leaves);
        }
    }
}

bool write_json(const AllFigures& all, const std::filesystem::path& file) {
    nlohmann::json json;
    for (const auto& [resolution, rows] : all) {
        for (const auto& [name, figures] : rows) {
            const auto ratio = ratio_of(figures, rows);
            json[resolution][name] = {{"ms_median", quantile(figures.run_ms, 0.5)},
                                      {"ms_p95", quantile(figures.run_ms, 0.95)},
                                      {"ratio_octomap", ratio ? nlohmann::json(*ratio) : nlohmann::json()},
                                      {"heap_bytes", figures.heap_bytes},
                                      {"leaves", figures.leaves},
                                      {"voxels", figures.voxels},
                                      {"runs", figures.run_ms.size()}};
        }
    }
    std::ofstream out(file);
    out << json.dump(2) << "\n";
    return static_cast<bool>(out.flush());
}

}  // namespace octoskin::bench
