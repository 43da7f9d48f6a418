#include "tests/support/i2c_device/range_function.hpp"

#include <charconv>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

namespace octoskin::test {
namespace {

constexpr std::string_view kFile = "file:";

std::vector<std::string> fields(const std::string& text) {
    std::vector<std::string> parts(1);
    for (const char character : text) {
        if (character == ':') {
            parts.emplace_back();
        } else {
            parts.back().push_back(character);
        }
    }
    return parts;
}

std::optional<std::int64_t> whole_number(const std::string& text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < 0 || value > 1'000'000) {
        return std::nullopt;
    }
    return value;
}

double triangle(std::int64_t near_mm, std::int64_t far_mm, std::int64_t period_us, sim::SimTime time) {
    const std::int64_t phase_us = time.us % period_us;
    const std::int64_t from_near_us = phase_us < period_us / 2 ? phase_us : period_us - phase_us;
    return static_cast<double>(near_mm) + static_cast<double>(far_mm - near_mm) *
                                              static_cast<double>(2 * from_near_us) /
                                              static_cast<double>(period_us);
}

}  // namespace

std::optional<std::optional<double>> true_range_mm(const std::string& text, sim::SimTime time) {
    if (text.starts_with(kFile)) {
        std::ifstream file(text.substr(kFile.size()));
        std::string line;
        if (!std::getline(file, line) || line.starts_with(kFile)) return std::nullopt;
        return true_range_mm(line, time);
    }
    const std::vector<std::string> parts = fields(text);
    if (parts.size() == 1 && parts[0] == "none") return std::optional<double>{};
    std::vector<std::int64_t> numbers;
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const auto number = whole_number(parts[i]);
        if (!number) return std::nullopt;
        numbers.push_back(*number);
    }
    if (parts[0] == "constant" && numbers.size() == 1) return static_cast<double>(numbers[0]);
    if (parts[0] == "triangle" && numbers.size() == 3 && numbers[0] <= numbers[1] && numbers[2] > 0) {
        return triangle(numbers[0], numbers[1], numbers[2] * 1'000, time);
    }
    return std::nullopt;
}

sim::RangingScene scene_of(std::string text) {
    return [text = std::move(text)](std::uint32_t, sim::SimTime middle, const Roi&) {
        const auto range_mm = true_range_mm(text, middle).value_or(std::nullopt);
        if (!range_mm) {
            return sim::RangingReturn{
                .range_m = std::nullopt, .sigma_m = 0.0, .peak_signal_mcps = 0.0, .ambient_mcps = 0.5};
        }
        return sim::RangingReturn{.range_m = *range_mm / 1'000.0,
                                  .sigma_m = 0.005,
                                  .peak_signal_mcps = 16.0,
                                  .ambient_mcps = 0.125};
    };
}

}  // namespace octoskin::test
