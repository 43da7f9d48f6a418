// The output of octoskin-mesh-read: triangles as bytes of this machine.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "hw/mesh/triangle_mesh.hpp"

namespace octoskin {

/// Most vertices and triangles of one file.
inline constexpr std::size_t kMeshVerticesMax = 6'000'000;
inline constexpr std::size_t kMeshTrianglesMax = 2'000'000;

[[nodiscard]] std::string to_bytes(const TriangleMesh& mesh);
/// Empty unless the bytes are a whole mesh of at least one triangle, within the limits, with finite
/// coordinates and only indices of vertices that exist.
[[nodiscard]] std::optional<TriangleMesh> mesh_of(std::string_view bytes);

}  // namespace octoskin
