// Checks of a mesh file's bytes before assimp reads them: assimp leaves out what it does not understand, and
// a link of a robot would have a part of its body.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"

namespace octoskin {

struct MeshText {
    /// Triangles that a reader has to find; an instance of a part counts like the part.
    std::size_t triangles = 0;
    /// Of the triangles' corners; none where they are not read (STL, COLLADA).
    std::optional<Eigen::AlignedBox3d> box;
};

/// `ending`: ".stl", ".obj" or ".dae", in letters of any case. The error ends a sentence that begins with the
/// mesh: "line 3: a vertex has 5 numbers, expected 3". A number has at most 15 digits before its point.
/// - STL: as text, it has only solids of triangles, up to an `endsolid`, and no words behind the numbers; in
///   binary form, all of its triangles.
/// - OBJ: each vertex has 3 numbers, 4 with a weight, or 6 with a colour, each with a digit first; its
///   keywords are in small letters at the begin of a line; no line goes on with a backslash; no comment
///   behind a vertex has numbers; no surface is curved; there is no byte order mark.
/// - COLLADA: see collada_text.hpp.
[[nodiscard]] Result<MeshText, std::string> check_mesh_text(std::string_view ending, std::string_view bytes);

}  // namespace octoskin
