// Figures over seeds: mean, spread, and differences paired by seed. The spread over seeds comes mostly from
// the voxel phase; a paired difference cancels it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/lab/evaluation/metrics.hpp"

namespace octoskin::evaluation {

/// The metrics of one map of one configuration and one seed.
struct Run {
    std::string configuration;  ///< "robust"
    std::string map;            ///< "fused"
    std::uint64_t seed = 0;
    Metrics metrics;
};

/// One figure over seeds. A seed where it is undefined is empty in `per_seed` and left out of the statistics.
struct Summary {
    std::optional<double> mean;
    std::optional<double> sd;  ///< sample standard deviation (n - 1); empty below two values
    std::vector<std::optional<double>> per_seed;
};
[[nodiscard]] Summary summarise(std::vector<std::optional<double>> per_seed);

using MetricSummaries = std::map<std::string, Summary, std::less<>>;
/// Whether a metric of the group has a mean: none has of what a camera sees if there is no camera.
[[nodiscard]] bool has_group(const MetricSummaries& metrics, MetricGroup group);

/// Seen voxels of several seeds.
struct SeenPool {
    SharesByClass by_class;
    SeenShares too_coarse;
};

/// One map of one configuration over all its seeds.
struct MapSummary {
    std::string configuration;
    std::string map;
    std::vector<std::uint64_t> seeds;  ///< ascending; the order of `per_seed`
    MetricSummaries metrics;
    Calibration calibration;                ///< pooled over the seeds
    FreeCalibration free_calibration = {};  ///< likewise
    /// Seen voxels by thickness, pooled over the seeds; empty without a camera.
    std::optional<SeenPool> seen = std::nullopt;

    /// The metric must exist (asserted).
    [[nodiscard]] const Summary& at(std::string_view metric) const;
};

/// One summary per configuration and map, in the order of their first run. Each seed occurs once for each of
/// them (asserted).
[[nodiscard]] std::vector<MapSummary> aggregate(std::span<const Run> runs);

/// Empty if there is none.
[[nodiscard]] const MapSummary* find_map(std::span<const MapSummary> summaries,
                                         std::string_view configuration, std::string_view map);

/// `minuend` - `subtrahend`, seed by seed, over the seeds that both have.
struct PairedDifference {
    std::string name;  ///< "robust/fused - robust/depth"
    std::vector<std::uint64_t> seeds;
    MetricSummaries metrics;
};
[[nodiscard]] PairedDifference paired_difference(const MapSummary& minuend, const MapSummary& subtrahend);

/// The comparisons of the experiment: in each configuration fused - depth and fused - proximity, and for
/// every pair of configurations the later one's fused map minus the earlier one's.
[[nodiscard]] std::vector<PairedDifference> standard_differences(std::span<const MapSummary> summaries);

}  // namespace octoskin::evaluation
