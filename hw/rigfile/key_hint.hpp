// Hints for an unknown key.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octoskin::rig {

/// The one of `known` that differs from `word` by a typing error: up to two letters changed, added or
/// missing.
[[nodiscard]] std::optional<std::string> nearest_word(std::string_view word,
                                                      std::span<const std::string> known);

/// The remedy for an unknown key: the known key that differs in its unit only ("did you mean pose.xyz_m: the
/// unit is part of the name"), else the one that differs by a slip of the pen, else all known keys.
[[nodiscard]] std::string hint_for_key(std::string_view key, std::span<const std::string_view> known_keys,
                                       const std::string& table_path);

}  // namespace octoskin::rig
