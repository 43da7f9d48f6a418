// Line charts as inline SVG: axes, ticks, labels, lines, dots. Colours come from the page's style sheet by
// class name, for its light and dark themes.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/lab/report/image.hpp"

namespace octoskin::report {

/// Round numbers (1, 2 or 5 times a power of ten apart) within [low, high], about `count` of them.
[[nodiscard]] std::vector<double> round_ticks(double low, double high, int count);

/// Number of decimals that distinguishes neighbouring ticks, 0 to 6; 2 for fewer than two ticks.
[[nodiscard]] int tick_digits(const std::vector<double>& ticks);

/// Width and height of a chart beyond the area between its axes, pixels.
inline constexpr double kChartMarginX_px = 82.0;
inline constexpr double kChartMarginY_px = 68.0;

struct Axis {
    double low = 0.0;
    double high = 1.0;
    std::string label;
    int tick_count = 5;
};

struct ChartPoint {
    double x = 0.0;
    double y = 0.0;
};

class Chart {
  public:
    /// `low` < `high` on both axes (asserted). Size in pixels of the drawing's own scale.
    Chart(Axis x, Axis y, double width = 640.0, double height = 400.0);

    void line(const std::vector<ChartPoint>& points, std::string_view css_class);
    /// `radius` in pixels.
    void dot(ChartPoint at, double radius, std::string_view css_class);
    /// `dx`, `dy`: pixels right and down of the point; `anchor`: start, middle, end.
    void text(ChartPoint at, double dx, double dy, std::string_view text, std::string_view css_class,
              std::string_view anchor = "start");

    /// A picture (PNG) over the area between two corners, its pixels as squares.
    void image(ChartPoint low, ChartPoint high, const Image& picture);

    /// The whole <svg> element. `title`: for screen readers.
    [[nodiscard]] std::string svg(std::string_view title) const;

  private:
    [[nodiscard]] double column(double x) const;
    [[nodiscard]] double row(double y) const;
    [[nodiscard]] std::string axes() const;

    Axis x_;
    Axis y_;
    double width_;
    double height_;
    std::string marks_;
};

}  // namespace octoskin::report
