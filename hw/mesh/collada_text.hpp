// Checks of a COLLADA file before assimp reads it: assimp leaves out what it does not understand.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "common/result.hpp"

namespace octoskin {

/// The triangles of all instances in the scene: polygons have two less than corners, lines none. The content
/// of `<extra>` has no part in it. The error names the line. Each file
/// - has surfaces of `<triangles>`, `<polylist>`, `<polygons>` and `<tristrips>`, with a `count`;
/// - has corners by accessors with the params X, Y and Z;
/// - has, for each `url` of an instance, one element of its kind in this file;
/// - has plain numbers, uninterrupted by comments, in each transform and surface;
/// - has a positive `<unit>`, `<matrix>` with the last row 0 0 0 1, `<rotate>` about an axis of length 1, and
///   neither `<skew>` nor `<lookat>`;
/// - has no prefixes of XML namespaces in its elements' names.
[[nodiscard]] Result<std::size_t, std::string> check_collada_text(std::string_view bytes);

}  // namespace octoskin
