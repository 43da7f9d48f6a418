// Figures of a run: one row for each integrator at each resolution.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace octoskin::bench {

struct Figures {
    std::vector<double> frame_ms;  ///< CPU time
    std::size_t heap_bytes = 0;    ///< of the map at the end
    std::size_t voxels = 0;        ///< known, at the finest level
    std::size_t leaves = 0;        ///< of OctoMap's tree, pruned; 0: no tree
};

/// By resolution in metres, then by integrator.
using AllFigures = std::map<std::string, std::map<std::string, Figures>>;

/// Of `share` of the values; they are not empty (asserted).
[[nodiscard]] double quantile(std::vector<double> values, double share);
void print(const AllFigures& all);
/// False if the file could not be written.
[[nodiscard]] bool write_json(const AllFigures& all, const std::filesystem::path& file);

}  // namespace octoskin::bench
