// What to say about a key nobody knows.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace octoskin::rig {

/// The remedy for an unknown key: the known key that differs in its unit only ("did you mean pose.xyz_m: the
/// unit is part of the name"), else the one that differs by a slip of the pen, else all known keys.
[[nodiscard]] std::string hint_for_key(std::string_view key,
                                       std::initializer_list<std::string_view> known_keys,
                                       const std::string& table_path);

}  // namespace octoskin::rig
