// The report's three charts, each as an <svg> element.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/apps/evaluation/aggregate.hpp"
#include "host/core/mapping/update_model.hpp"

namespace octoskin::report {

/// The style sheet's class of a map: "depth", "proximity", "fused", or "other".
[[nodiscard]] std::string_view css_class_of(std::string_view map) noexcept;

/// Probability of a voxel after one hit, over the range, for both sensors: Strong et al. 2021, Fig. 2.
[[nodiscard]] std::string update_curves_svg(const UpdateModel& model);

/// Reliability diagram of the maps of one configuration: observed share of surface voxels over predicted
/// probability; a dot's radius grows with the logarithm of the voxels.
[[nodiscard]] std::string calibration_svg(std::span<const evaluation::MapSummary* const> maps);

/// One row per metric: a dot per seed, the mean as a bar. `metrics`: names as in `metric_fields`; rows
/// without any defined value are left out. Empty if none is left.
[[nodiscard]] std::string paired_svg(const evaluation::PairedDifference& difference,
                                     const std::vector<std::string_view>& metrics, std::string_view unit);

}  // namespace octoskin::report
