// All results of an evaluation as one value, and its output as metrics.json and as the printed table. The
// report is in host/lab/report.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/lab/evaluation/aggregate.hpp"
#include "host/lab/evaluation/unknown_space.hpp"

namespace octoskin::evaluation {

/// Time spent on one part ("simulate", "replay robust", "evaluate"), summed over the seeds.
struct PartTime {
    std::string part;
    double wall_s = 0.0;
    double cpu_s = 0.0;
};

struct Results {
    std::vector<std::uint64_t> seeds;
    std::vector<MapSummary> maps;
    std::vector<PairedDifference> paired;
    std::vector<PartTime> times;
    /// What the figures depend on: program version, world, rig, recording ("key", "value").
    std::vector<std::pair<std::string, std::string>> provenance;
    /// The run repeats the paper's experiment. Only then are the paper's figures shown beside its own.
    bool is_papers_experiment = false;
    /// Of the first seed in the main configuration of the report.
    std::optional<UnknownSpace> unknown_space;
};

/// Aggregates and pairs.
[[nodiscard]] Results collect(std::span<const Run> runs, std::vector<PartTime> times = {},
                              std::vector<std::pair<std::string, std::string>> provenance = {});

/// JSON text: configuration -> map -> metric -> {mean, sd, per_seed}, and under the one reserved key "run"
/// the seeds, paired differences, calibration tables, free voxels by evidence, seen voxels by thickness,
/// times and provenance. Undefined values are null. No configuration may have this name (asserted). Equal
/// results give equal text.
[[nodiscard]] std::string metrics_json(const Results& results);

/// Text tables for a terminal, about 100 columns: Table I and Lost (beside the paper's figures if the
/// experiment is the paper's), all metrics as mean +- sd, seen voxels by thickness, free voxels by
/// evidence, the paired differences, the times.
[[nodiscard]] std::string metrics_table(const Results& results);

/// Table I of Strong et al. 2021.
struct PaperRow {
    std::string_view map;  ///< our name for it
    std::uint64_t occupied;
    std::uint64_t free;
    std::uint64_t missed;
    std::uint64_t incorrect;
};
inline constexpr std::array<PaperRow, 3> kPaperTable{{
    {"depth", 970, 27510, 3523, 299},
    {"proximity", 587, 47847, 3697, 26},
    {"fused", 1430, 66697, 2469, 317},
}};

}  // namespace octoskin::evaluation
