// Reads a mesh file (STL, OBJ or COLLADA) with assimp: the only file that includes it.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "hw/sim/world/sdf/world_files.hpp"
#include "hw/sim/world/solid.hpp"

namespace octoskin::sim {

/// All triangles of the file, whose name ends in .stl, .obj or .dae, in the file's own coordinates, node
/// transforms applied. The error is assimp's message, or that there is no triangle or a coordinate that is
/// not finite. `files`: the allowed files, for the mesh and the files that it refers to (materials, buffers);
/// nullptr: any.
[[nodiscard]] Result<TriangleMesh, std::string> read_mesh(const std::filesystem::path& file,
                                                          const WorldFiles* files = nullptr);

}  // namespace octoskin::sim
