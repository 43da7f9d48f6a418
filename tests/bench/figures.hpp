// Figures of a bench: by resolution and row.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace octoskin::bench {

struct Figures {
    std::string peer;            ///< the row it is compared with, OctoMap's mostly; empty if there is none
    std::vector<double> run_ms;  ///< CPU time of all threads, or by the clock: Row::is_by_clock
    std::size_t heap_bytes = 0;  ///< of the map at the end; 0: no map
    std::size_t voxels = 0;      ///< known, at the finest level
    std::size_t leaves = 0;      ///< of the map as a pruned octree
};

/// By resolution in metres, then by row.
using AllFigures = std::map<std::string, std::map<std::string, Figures>>;

/// Of `share` of the values; they are not empty (asserted).
[[nodiscard]] double quantile(std::vector<double> values, double share);
void print(const AllFigures& all);
/// resolution -> row -> ms_median, ms_p95, ratio_octomap (null without a peer in this run), heap_bytes,
/// leaves, voxels, runs. False if the file could not be written.
[[nodiscard]] bool write_json(const AllFigures& all, const std::filesystem::path& file);

}  // namespace octoskin::bench
