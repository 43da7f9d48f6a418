// The sections of the report as HTML, in their order.
#pragma once

#include <string>

#include "host/lab/report/report.hpp"

namespace octoskin::report {

[[nodiscard]] std::string headline_section(const ReportInput& input);
[[nodiscard]] std::string pictures_section(const ReportInput& input);
/// Empty without maps or script.
[[nodiscard]] std::string view_section(const ReportInput& input);
[[nodiscard]] std::string paper_section(const ReportInput& input);
[[nodiscard]] std::string paired_section(const ReportInput& input);
[[nodiscard]] std::string unknown_section(const ReportInput& input);
[[nodiscard]] std::string metrics_section(const ReportInput& input);
/// Empty without a camera.
[[nodiscard]] std::string thickness_section(const ReportInput& input);
/// Empty if no map has free voxels.
[[nodiscard]] std::string free_section(const ReportInput& input);
[[nodiscard]] std::string update_section(const ReportInput& input);
[[nodiscard]] std::string calibration_section(const ReportInput& input);
[[nodiscard]] std::string inputs_section(const ReportInput& input);
[[nodiscard]] std::string idealisations_section(const ReportInput& input);
[[nodiscard]] std::string times_section(const ReportInput& input);
[[nodiscard]] std::string reproduce_section(const ReportInput& input);

/// "cone, crate", escaped.
[[nodiscard]] std::string hidden_objects_text(const ReportInput& input);

/// A chart with its caption; empty if there is no chart. `caption`: HTML.
[[nodiscard]] std::string chart_figure(const std::string& svg, std::string_view caption);
/// One entry of a legend of lines.
[[nodiscard]] std::string legend_entry(std::string_view map, std::string_view title);

/// "Depth camera", or "2 depth cameras".
[[nodiscard]] std::string cameras_title(const ReportInput& input);
/// The fused map in the words of the report; unknown names as they are, escaped.
[[nodiscard]] std::string map_title(std::string_view map, const ReportInput& input);

}  // namespace octoskin::report
