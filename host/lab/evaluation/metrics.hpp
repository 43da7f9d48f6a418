// One map against the ground truths: every figure by its full name. docs/reference/evaluation.md has the
// domain of each.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "host/core/mapping/free_evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/lab/evaluation/free_calibration.hpp"
#include "host/lab/evaluation/seen.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/evaluation/voxel_grid.hpp"

namespace octoskin::evaluation {

/// State of one voxel in a map. An unknown voxel has the prior probability 0.5.
struct MapVoxel {
    Occupancy occupancy = Occupancy::unknown;
    float probability = 0.5F;
};

/// The map's content over a box. O(size * tree depth), about 20 ms for the experiment's region.
[[nodiscard]] VoxelGrid<MapVoxel> sample_map(const FusedMap& map, const KeyBox& box);

/// Known voxels whose probability lies in [i / 10, (i + 1) / 10).
struct CalibrationBin {
    std::uint64_t count = 0;
    double probability_sum = 0.0;
    std::uint64_t occupied_count = 0;  ///< of them surface voxels

    [[nodiscard]] std::optional<double> mean_predicted() const noexcept;
    [[nodiscard]] std::optional<double> observed_fraction() const noexcept;
};
inline constexpr std::size_t kCalibrationBins = 10;
using Calibration = std::array<CalibrationBin, kCalibrationBins>;

/// What ranges have changed, in a map that also has the camera's images. Ratios are empty where the
/// denominator is 0.
struct BesideCamera {
    /// Occupied in the camera truth and free in the map: of these, unknown in the camera's own map.
    std::uint64_t lost_beyond_camera = 0;
    /// Of surface voxels that the camera's map has as occupied, the share that is free in this map.
    std::optional<double> freed_occupied;
    /// Of seen voxels that the camera's map has as unknown, the share that is free in this map.
    std::optional<double> freed_seen_unknown;
};

struct Metrics {
    // Against the camera truth, voxels of the region (Strong et al. 2021, Table I, and the column it leaves
    // out).
    std::uint64_t occupied = 0;   ///< occupied in truth and in the map
    std::uint64_t free = 0;       ///< free in truth and in the map
    std::uint64_t missed = 0;     ///< occupied in truth, unknown in the map
    std::uint64_t incorrect = 0;  ///< occupied in the map, free or unknown in truth
    std::uint64_t lost = 0;       ///< occupied in truth, free in the map

    // Against the analytic surfaces, voxels of the region that are not interior to a solid. Empty where the
    // denominator is 0.
    std::optional<double> precision;
    std::optional<double> recall;
    std::optional<double> f1;
    std::optional<double> iou;
    std::optional<double> precision_tolerant;  ///< one voxel beside a surface is right too
    std::optional<double> occluded_recall;     ///< recall on surface voxels that no camera sees
    std::optional<double> object_recall;       ///< the same on the hidden objects only
    std::optional<double> coverage;            ///< known voxels / all
    std::optional<double> log_loss;            ///< natural logarithm; unknown predicts 0.5
    std::optional<double> brier;
    Calibration calibration;
    FreeCalibration free_calibration;

    std::optional<SeenMetrics> seen = std::nullopt;            ///< of the external cameras; empty without one
    std::optional<BesideCamera> beside_camera = std::nullopt;  ///< empty without the camera's map
};

/// `map` must be over the truth's region (asserted). Without `seen` and `free_calibration`, which need more
/// of the map.
[[nodiscard]] Metrics compute_metrics(const VoxelGrid<MapVoxel>& map, const Truth& truth);

/// `map` and `camera_map` are of one recording, the second of its images alone. Both must be over the truth's
/// region (asserted).
[[nodiscard]] BesideCamera compare(const VoxelGrid<MapVoxel>& map, const VoxelGrid<MapVoxel>& camera_map,
                                   const Truth& truth);

/// Samples the map over the truth's region and computes the metrics. `units`: of the mapping that made the
/// map. `camera_map`: null, or the map of the images alone, which `map` is compared with. The resolutions
/// must be equal (asserted).
[[nodiscard]] Metrics evaluate(const FusedMap& map, const Truth& truth, const MissUnits& units,
                               const FusedMap* camera_map = nullptr);

/// What scalar metrics compare with: tables have a part for each.
enum class MetricGroup : std::uint8_t { camera_truth, surfaces, probabilities, seen, beside_camera };
/// "camera truth", "seen by the camera".
[[nodiscard]] std::string_view title_of(MetricGroup group) noexcept;

/// A scalar metric by name, for tables and files. `is_count`: print without decimals.
/// `is_more_better`: a larger value is the better one.
struct MetricField {
    std::string_view name;
    MetricGroup group;
    bool is_count;
    bool is_more_better;
    std::optional<double> (*value)(const Metrics&);
};
/// All scalar metrics, in the order in which they are printed, group by group.
[[nodiscard]] std::span<const MetricField> metric_fields() noexcept;

}  // namespace octoskin::evaluation
