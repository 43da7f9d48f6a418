// A list of names from outside in a sentence.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace octoskin::bridge {

/// "a, b, c, d and 3 more": the first few, of each at most 64 bytes.
[[nodiscard]] inline std::string first_names(const std::vector<std::string>& names) {
    constexpr std::size_t kShown = 4;
    constexpr std::size_t kBytesMax = 64;
    std::vector<std::string> shown;
    for (std::size_t i = 0; i < std::min(names.size(), kShown); ++i)
        shown.push_back(names[i].substr(0, kBytesMax));
    std::string text = fmt::format("{}", fmt::join(shown, ", "));
    if (names.size() > kShown) text += fmt::format(" and {} more", names.size() - kShown);
    return text;
}

}  // namespace octoskin::bridge
