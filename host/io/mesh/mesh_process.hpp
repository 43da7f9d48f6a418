// Reads a mesh file in a process with limits: assimp may crash, loop or use all memory on a damaged file.
#pragma once

#include <filesystem>
#include <optional>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/mesh/mesh_copy.hpp"
#include "hw/mesh/triangle_mesh.hpp"

namespace octoskin {

/// The name of the helper program.
inline constexpr const char* kMeshReader = "octoskin-mesh-read";

/// The triangles of an STL, OBJ or COLLADA file, metres before URDF's `scale` (hw/mesh/mesh_file.hpp). The
/// helper reads this file only: a material file beside it is not needed. Errors name the file: foreign_format
/// with assimp's sentence, no_program. `helper`: replaces the installed one.
[[nodiscard]] Result<TriangleMesh, Error> read_mesh_in_process(
    const MeshCopy& mesh, const std::optional<std::filesystem::path>& helper = {});

}  // namespace octoskin
