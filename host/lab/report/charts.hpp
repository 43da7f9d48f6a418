// The report's charts, each as an <svg> element.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/mapping/update_model.hpp"
#include "host/lab/evaluation/aggregate.hpp"
#include "host/lab/evaluation/unknown_space.hpp"
#include "host/lab/report/report.hpp"

namespace octoskin::report {

/// The style sheet's class of a map: "depth", "proximity", "fused", or "other".
[[nodiscard]] std::string_view css_class_of(std::string_view map) noexcept;

/// Probability of a voxel after one hit, over the range, for the camera, and for range sensors that are ideal
/// rays if there are any. As Strong et al. 2021, Fig. 2.
[[nodiscard]] std::string update_curves_svg(const UpdateModel& model, bool has_rays = true);

/// Probability of a voxel over the number of ranges that hit it or passed it, without other measurements; for
/// whole cones and for zones. There must be one of the two (asserted).
[[nodiscard]] std::string counting_curves_svg(const RangeCounting& counting);

/// Reliability diagram of the maps of one configuration: observed share of surface voxels over predicted
/// probability; a dot's radius grows with the logarithm of the voxels.
[[nodiscard]] std::string calibration_svg(std::span<const evaluation::MapSummary* const> maps);

/// One row per metric: a dot per seed, the mean as a bar. `metrics`: names as in `metric_fields`; rows
/// without any defined value are left out. Empty if none is left.
[[nodiscard]] std::string paired_svg(const evaluation::PairedDifference& difference,
                                     const std::vector<std::string_view>& metrics, std::string_view unit);

/// Unknown volume over time. There must be a sample (asserted).
[[nodiscard]] std::string unknown_curves_svg(const evaluation::UnknownSpace& space);

/// The greatest unknown height of any column of any map, metres.
[[nodiscard]] double unknown_column_max_m(const evaluation::UnknownSpace& space) noexcept;
/// Unknown space at the end, from above, in metres from the robot's base: with the camera alone (such a map
/// must exist, asserted), and fused with the numbers of the first `count` pockets. Opacity grows with the
/// unknown height of a column, up to `unknown_column_max_m`.
[[nodiscard]] std::string depth_columns_svg(const evaluation::UnknownSpace& space);
[[nodiscard]] std::string fused_columns_svg(const evaluation::UnknownSpace& space, std::size_t count);

}  // namespace octoskin::report
