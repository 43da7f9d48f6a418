// Figures of a bench: by resolution and row.
#pragma once

#include <cstddef>
#include <cstdint>
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
    /// CPU time of each run by the step's name; empty for most rows.
    std::map<std::string, std::vector<double>> parts_ms;
};

/// Images of a data set in place of those of the furnished room.
struct DataSetFrames {
    std::string folder;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    double mean_depth_m = 0.0;
};

/// By resolution in metres, then by row.
using AllFigures = std::map<std::string, std::map<std::string, Figures>>;

/// Of `share` of the values; they are not empty (asserted).
[[nodiscard]] double quantile(std::vector<double> values, double share);
void print(const AllFigures& all);
/// resolution -> row -> ms_median, ms_p95, ratio_octomap (null without a peer in this run), heap_bytes,
/// leaves, voxels, runs, and parts_ms with the median of each step. Of a data set the file has "frames", too.
/// False if the file could not be written.
[[nodiscard]] bool write_json(const AllFigures& all, const std::optional<DataSetFrames>& frames,
                              const std::filesystem::path& file);

}  // namespace octoskin::bench
