#include "hw/rigfile/key_hint.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "hw/rigfile/joined.hpp"

namespace octoskin::rig {
namespace {

constexpr std::array<std::string_view, 24> kUnits = {
    "m",  "mm",  "cm",  "km",  "um",   "s",    "ms",   "us",   "ns",    "hz",   "khz", "mhz",
    "px", "deg", "rad", "bps", "kbps", "mbps", "mcps", "kcps", "spads", "mrad", "min", "percent"};
constexpr std::size_t kSlipMax = 2;  ///< letters changed, added or missing

std::string_view without_unit(std::string_view key) {
    const auto split = key.rfind('_');
    if (split == std::string_view::npos) return key;
    const auto unit = key.substr(split + 1);
    return std::find(kUnits.begin(), kUnits.end(), unit) == kUnits.end() ? key : key.substr(0, split);
}

/// Levenshtein's distance: letters to change, add or drop.
std::size_t edit_distance(std::string_view from, std::string_view to) {
    std::vector<std::size_t> row(to.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= from.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i);
        for (std::size_t j = 1; j <= to.size(); ++j) {
            const std::size_t changed = diagonal + (from[i - 1] == to[j - 1] ? 0 : 1);
            diagonal = std::exchange(row[j], std::min({changed, row[j] + 1, row[j - 1] + 1}));
        }
    }
    return row.back();
}

}  // namespace

std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known) {
    const std::string_view short_word = word.substr(0, 64);
    std::optional<std::string> nearest;
    std::size_t least = kSlipMax + 1;
    for (const std::string& one : known) {
        const std::size_t distance = edit_distance(short_word, one);
        if (distance >= least) continue;
        least = distance;
        nearest = one;
    }
    return nearest;
}

std::string hint_for_key(std::string_view key, std::span<const std::string_view> known_keys,
                         const std::string& table_path) {
    const std::string prefix = table_path.empty() ? "" : table_path + ".";
    for (const auto known : known_keys) {
        if (without_unit(key) != without_unit(known)) continue;
        return "did you mean " + prefix + std::string(known) +
               "? (the unit is part of the name, and the value must be in it)";
    }
    const std::vector<std::string> all(known_keys.begin(), known_keys.end());
    if (const auto near = nearest_word(key, all)) return "did you mean " + prefix + *near + "?";
    return "known here are " + joined(known_keys);
}

}  // namespace octoskin::rig
