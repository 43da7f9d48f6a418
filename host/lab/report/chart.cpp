#include "host/lab/report/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/lab/report/text.hpp"

namespace octoskin::report {
namespace {

constexpr double kLeft = 64.0;
constexpr double kRight = 18.0;
constexpr double kTop = 16.0;
constexpr double kBottom = 52.0;
static_assert(kLeft + kRight == kChartMarginX_px && kTop + kBottom == kChartMarginY_px);

}  // namespace

std::vector<double> round_ticks(double low, double high, int count) {
    assert(low < high && count > 0);
    const double raw = (high - low) / count;
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    const double share = raw / power;
    const double step = power * (share <= 1.5 ? 1.0 : share <= 3.5 ? 2.0 : share <= 7.5 ? 5.0 : 10.0);
    std::vector<double> ticks;
    const auto first = static_cast<long>(std::ceil(low / step - 1e-9));
    const auto last = static_cast<long>(std::floor(high / step + 1e-9));
    for (long i = first; i <= last; ++i) {
        ticks.push_back(static_cast<double>(i) * step);
    }
    return ticks;
}

int tick_digits(const std::vector<double>& ticks) {
    if (ticks.size() < 2) {
        return 2;
    }
    const double step = ticks[1] - ticks[0];
    return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
}

Chart::Chart(Axis x, Axis y, double width, double height)
    : x_(std::move(x)), y_(std::move(y)), width_(width), height_(height) {
    assert(x_.low < x_.high && y_.low < y_.high);
}

double Chart::column(double x) const {
    return kLeft + (x - x_.low) / (x_.high - x_.low) * (width_ - kLeft - kRight);
}

double Chart::row(double y) const {
    return height_ - kBottom - (y - y_.low) / (y_.high - y_.low) * (height_ - kTop - kBottom);
}

void Chart::line(const std::vector<ChartPoint>& points, std::string_view css_class) {
    std::string path;
    for (const auto& point : points) {
        path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", column(point.x), row(point.y));
    }
    marks_ += fmt::format("<polyline class=\"line {}\" points=\"{}\"/>\n", css_class, path);
}

void Chart::dot(ChartPoint at, double radius, std::string_view css_class) {
    marks_ += fmt::format("<circle class=\"dot {}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>\n", css_class,
                          column(at.x), row(at.y), radius);
}

void Chart::text(ChartPoint at, double dx, double dy, std::string_view text, std::string_view css_class,
                 std::string_view anchor) {
    marks_ += fmt::format("<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n",
                          css_class, column(at.x) + dx, row(at.y) + dy, anchor, escaped(text));
}

void Chart::image(ChartPoint low, ChartPoint high, const Image& picture) {
    marks_ += fmt::format(
        "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" preserveAspectRatio=\"none\" "
        "style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>\n",
        column(low.x), row(high.y), column(high.x) - column(low.x), row(low.y) - row(high.y),
        base64(encode_png(picture)));
}

std::string Chart::axes() const {
    std::string svg;
    const auto x_ticks = round_ticks(x_.low, x_.high, x_.tick_count);
    const auto y_ticks = round_ticks(y_.low, y_.high, y_.tick_count);
    const double left = column(x_.low);
    const double right = column(x_.high);
    const double bottom = row(y_.low);
    for (const double tick : y_ticks) {
        svg += fmt::format("<line class=\"grid\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                           left, right, row(tick), row(tick));
        svg += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                           left - 8.0, row(tick) + 4.0, ratio_text(tick, tick_digits(y_ticks)));
    }
    for (const double tick : x_ticks) {
        svg += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                           column(tick), column(tick), bottom, bottom + 5.0);
        svg +=
            fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                        column(tick), bottom + 20.0, ratio_text(tick, tick_digits(x_ticks)));
    }
    svg += fmt::format("<line class=\"axis\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>\n",
                       left, right, bottom, bottom);
    svg += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                       (left + right) / 2.0, height_ - 10.0, escaped(x_.label));
    const double middle = (row(y_.low) + row(y_.high)) / 2.0;
    svg += fmt::format(
        "<text class=\"label\" transform=\"translate(16 {:.1f}) rotate(-90)\" "
        "text-anchor=\"middle\">{}</text>\n",
        middle, escaped(y_.label));
    return svg;
}

std::string Chart::svg(std::string_view title) const {
    return fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n{}{}</svg>\n",
                       width_, height_, escaped(title), axes(), marks_);
}

}  // namespace octoskin::report
