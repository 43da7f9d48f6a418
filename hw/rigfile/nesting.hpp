// Detects text for which yaml-cpp or tinyxml2 need time quadratic in its length, before they parse it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace octoskin::rig {

struct TextFault {
    int line = 0;  ///< 1-based
    std::string what;
};

/// The first place where more than 64 brackets are open at once; no octoskin file has that many. Brackets in
/// quotes and comments are counted, too. O(text).
[[nodiscard]] std::optional<TextFault> deep_brackets(std::string_view yaml);

/// The first element with more than 100 attributes. O(text).
[[nodiscard]] std::optional<TextFault> crowded_element(std::string_view xml);

}  // namespace octoskin::rig
