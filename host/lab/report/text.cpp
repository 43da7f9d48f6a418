#include "host/lab/report/text.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace octoskin::report {
namespace {

constexpr std::string_view kMinus = "\u2212";
constexpr std::string_view kNarrowSpace = "\u202f";
constexpr std::string_view kNoBreakSpace = "\u00a0";
constexpr std::string_view kUndefined = "\u2013";

std::string with_minus(const std::string& number) {
    return number.starts_with('-') ? std::string(kMinus) + number.substr(1) : number;
}

/// Never "-0" or "-0.000": a difference that rounds to 0 has no sign.
std::string fixed(double value, int digits) {
    const double scale = std::pow(10.0, digits);
    const double rounded = std::round(value * scale) / scale;
    return fmt::format("{:.{}f}", rounded == 0.0 ? 0.0 : rounded, digits);
}

}  // namespace

std::string count_text(double count) {
    const std::string digits = fixed(std::abs(count), 0);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) {
            text += kNarrowSpace;
        }
        text += digits[i];
    }
    return count < 0.0 && digits != "0" ? std::string(kMinus) + text : text;
}

std::string ratio_text(double ratio, int digits) {
    return with_minus(fixed(ratio, digits));
}

std::string percent_text(double share, int digits) {
    return with_minus(fixed(100.0 * share, digits)) + std::string(kNoBreakSpace) + "%";
}

std::string signed_text(const std::string& number) {
    return number.starts_with(kMinus) ? number : "+" + number;
}

std::string value_text(const std::optional<double>& value, Style style) {
    if (!value) {
        return std::string(kUndefined);
    }
    const std::string number = style.is_count ? count_text(*value) : ratio_text(*value);
    return style.is_difference ? signed_text(number) : number;
}

std::string summary_text(const evaluation::Summary& summary, Style style) {
    std::string text = value_text(summary.mean, style);
    if (summary.mean && summary.sd) {
        text += " ± " + value_text(summary.sd, {.is_count = style.is_count});
    }
    return text;
}

}  // namespace octoskin::report
