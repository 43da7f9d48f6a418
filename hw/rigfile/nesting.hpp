// Detects text for which yaml-cpp or tinyxml2 need time quadratic in its length, before they parse it.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "host/errors/error.hpp"

namespace octoskin::rig {

/// The first place where more than 64 brackets are open at once; no octoskin file has that many. Brackets in
/// quotes and comments are counted, too. The error has no file. O(text).
[[nodiscard]] std::optional<Error> deep_brackets(std::string_view yaml);

/// The first element with more than 100 attributes. O(text).
[[nodiscard]] std::optional<Error> crowded_element(std::string_view xml);

}  // namespace octoskin::rig
