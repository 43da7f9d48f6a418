// Reads a mesh file (STL, OBJ or COLLADA) with assimp: the only user of that library.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "hw/mesh/allowed_files.hpp"
#include "hw/mesh/triangle_mesh.hpp"

namespace octoskin {

/// All triangles of the file, whose name ends in .stl, .obj or .dae, as ROS and Gazebo show them: inner
/// nodes' transforms and COLLADA's `<unit>` are applied, its `<up_axis>` is not. The error is assimp's
/// message, or that there is no triangle or a coordinate that is not finite. `files`: the allowed files, for
/// the mesh and the files that it refers to (materials, buffers); nullptr: any.
[[nodiscard]] Result<TriangleMesh, std::string> read_mesh(const std::filesystem::path& file,
                                                          const AllowedFiles* files = nullptr);

}  // namespace octoskin
