// The kinds of mesh files that a world or a robot may use.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

namespace octoskin {

/// The endings of their names.
inline constexpr std::array<std::string_view, 3> kMeshKinds{"stl", "obj", "dae"};

[[nodiscard]] inline bool is_mesh_kind(std::string_view ending) {
    return std::ranges::find(kMeshKinds, ending) != kMeshKinds.end();
}

/// By the ending of its name, case-insensitive.
[[nodiscard]] inline bool has_mesh_kind(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return !ending.empty() && is_mesh_kind(std::string_view(ending).substr(1));
}

}  // namespace octoskin
