// What takes yaml-cpp and tinyxml2 time that grows with the square of a file: known before they see it.
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

/// The first place where more brackets are open at once than any file of ours has: 64. Brackets in quotes and
/// comments count, too: no such text has that many. O(text).
[[nodiscard]] std::optional<TextFault> deep_brackets(std::string_view yaml);

/// The first element with more than 100 attributes. O(text).
[[nodiscard]] std::optional<TextFault> crowded_element(std::string_view xml);

}  // namespace octoskin::rig
