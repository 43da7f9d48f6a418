// Checks of a mesh file's bytes before assimp reads them: assimp leaves out what it does not understand, and
// a link of a robot would have a part of its body.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"

namespace octoskin {

struct MeshText {
    /// Triangles that a reader has to find; none where this is not counted (COLLADA).
    std::optional<std::size_t> triangles;
};

/// `ending`: ".stl", ".obj" or ".dae", in letters of any case. The error ends a sentence that begins with the
/// mesh: "line 3: a vertex has 5 numbers, expected 3".
/// - STL: as text, it has only solids of triangles, up to an `endsolid`; in binary form, all of its
/// triangles.
/// - OBJ: each vertex has 3 numbers, 4 with a weight, or 6 with a colour, each with a digit first; its
/// keywords
///   are in small letters; no line goes on with a backslash.
/// - COLLADA: each `url` of an instance is an element of this file, `<unit>` is positive, the last row of a
///   `<matrix>` is 0 0 0 1, no index of a surface is negative.
[[nodiscard]] Result<MeshText, std::string> check_mesh_text(std::string_view ending, std::string_view bytes);

}  // namespace octoskin
