#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/lab/report/chart.hpp"
#include "host/lab/report/charts.hpp"
#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

constexpr double kWidth = 560.0;
constexpr double kRowHeight = 34.0;
constexpr double kLabelWidth = 135.0;
constexpr double kValueWidth = 116.0;
constexpr double kFoot = 46.0;

struct Row {
    std::string_view metric;
    const evaluation::Summary* summary;
};

std::vector<Row> rows_of(const evaluation::PairedDifference& difference,
                         const std::vector<std::string_view>& metrics) {
    std::vector<Row> rows;
    for (const auto metric : metrics) {
        const auto found = difference.metrics.find(metric);
        if (found != difference.metrics.end() && found->second.mean) {
            rows.push_back({metric, &found->second});
        }
    }
    return rows;
}

/// Maps values to columns; always includes 0.
struct Scale {
    double low = 0.0;
    double high = 0.0;
    [[nodiscard]] double column(double value) const {
        return kLabelWidth + (value - low) / (high - low) * (kWidth - kLabelWidth - kValueWidth);
    }
};

Scale scale_of(const std::vector<Row>& rows) {
    Scale scale;
    for (const auto& row : rows) {
        for (const auto& value : row.summary->per_seed) {
            scale.low = std::min(scale.low, value.value_or(0.0));
            scale.high = std::max(scale.high, value.value_or(0.0));
        }
    }
    const double margin = std::max(0.06 * (scale.high - scale.low), 1e-6);
    return {scale.low - margin, scale.high + margin};
}

/// `metric` must exist: the rows are metrics of the difference.
const evaluation::MetricField& field_of(std::string_view metric) {
    const auto fields = evaluation::metric_fields();
    const auto found = std::ranges::find(fields, metric, &evaluation::MetricField::name);
    assert(found != fields.end());
    return *found;
}

/// The colour shows whether the change is an improvement, not its sign: fewer missed voxels are better.
std::string_view worth_of(const evaluation::MetricField& field, double change) {
    return (change >= 0.0) == field.is_more_better ? "better" : "worse";
}

std::string row_svg(const Row& row, double middle, const Scale& scale) {
    std::string name(row.metric);
    std::ranges::replace(name, '_', ' ');
    std::string svg =
        fmt::format("<text class=\"row\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                    kLabelWidth - 12.0, middle + 4.5, escaped(name));
    const double zero = scale.column(0.0);
    const double mean = scale.column(*row.summary->mean);
    svg += fmt::format("<rect class=\"bar {}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"12\"/>\n",
                       worth_of(field_of(row.metric), *row.summary->mean), std::min(zero, mean), middle - 6.0,
                       std::abs(mean - zero));
    for (const auto& value : row.summary->per_seed) {
        if (value) {
            svg += fmt::format("<circle class=\"seed\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.6\"/>",
                               scale.column(*value), middle);
        }
    }
    const Style style{.is_count = field_of(row.metric).is_count, .is_difference = true};
    svg += fmt::format("\n<text class=\"value\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                       kWidth, middle + 4.5, summary_text(*row.summary, style));
    return svg;
}

std::string scale_svg(const Scale& scale, double bottom, std::string_view unit) {
    std::string svg;
    const auto ticks = round_ticks(scale.low, scale.high, 6);
    for (const double tick : ticks) {
        const double column = scale.column(tick);
        svg += fmt::format("<line class=\"{}\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"4\" y2=\"{:.1f}\"/>",
                           tick == 0.0 ? "axis" : "grid", column, column, bottom);
        const std::string number =
            scale.high - scale.low > 20.0 ? count_text(tick) : ratio_text(tick, tick_digits(ticks));
        svg +=
            fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                        column, bottom + 16.0, tick == 0.0 ? "0" : signed_text(number));
    }
    svg += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                       (kLabelWidth + kWidth - kValueWidth) / 2.0, bottom + 36.0, escaped(unit));
    return svg;
}

}  // namespace

std::string paired_svg(const evaluation::PairedDifference& difference,
                       const std::vector<std::string_view>& metrics, std::string_view unit) {
    const auto rows = rows_of(difference, metrics);
    if (rows.empty()) {
        return {};
    }
    const Scale scale = scale_of(rows);
    const double bottom = kRowHeight * static_cast<double>(rows.size()) + 8.0;
    std::string svg = fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n",
                                  kWidth, bottom + kFoot, escaped(difference.name));
    svg += scale_svg(scale, bottom, unit);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        svg += row_svg(rows[i], 6.0 + kRowHeight * (static_cast<double>(i) + 0.5), scale);
    }
    return svg + "</svg>\n";
}

}  // namespace octoskin::report
