// Numbers and text as the report prints them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "host/core/text/markup.hpp"
#include "host/lab/evaluation/aggregate.hpp"

namespace octoskin::report {

/// "27 510" with narrow no-break spaces; rounded to the nearest; a minus is U+2212.
[[nodiscard]] std::string count_text(double count);
/// "0.620".
[[nodiscard]] std::string ratio_text(double ratio, int digits = 3);
/// "10.9 %" with a no-break space.
[[nodiscard]] std::string percent_text(double share, int digits = 1);
/// `number` with a plus sign if it is not negative.
[[nodiscard]] std::string signed_text(const std::string& number);

/// How a figure is written: as a count, or with three decimals; as a difference with its sign.
struct Style {
    bool is_count = false;
    bool is_difference = false;
};
/// "–" if it is undefined.
[[nodiscard]] std::string value_text(const std::optional<double>& value, Style style);
/// "0.620 ± 0.045"; for a single seed without the spread.
[[nodiscard]] std::string summary_text(const evaluation::Summary& summary, Style style);

}  // namespace octoskin::report
