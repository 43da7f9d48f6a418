// Copies a world into files of one folder that refer to no file outside it, for a recording.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::sim {

/// Limits of a world in a recording. The largest shipped world takes 0.1 MiB.
inline constexpr std::size_t kWorldBytesMax = std::size_t{16} << 20U;
inline constexpr std::size_t kMeshBytesMax = std::size_t{64} << 20U;
inline constexpr std::size_t kMeshesBytesMax = std::size_t{256} << 20U;  ///< of all together
inline constexpr std::size_t kMeshesMax = 99;

struct MeshCopy {
    std::string name;  ///< "mesh_01.stl"
    std::string bytes;
};

struct WorldCopy {
    std::string sdf;  ///< the same world with the new names of the meshes
    std::vector<MeshCopy> meshes;
    std::vector<std::string> left_out;  ///< the uris of the meshes left out, each once
};

/// Reads the world's file and those of its meshes, each once. `meshes`: World::meshes(), the uris of those
/// that were read as shapes; any other file that the world names as a mesh, such as that of a collision, is
/// left out, because it may be a private file of the user. `written_out`: World::written_out(), used in place
/// of a file that includes models. Errors: it still includes models, a mesh cannot be read or does not have
/// the ending of a mesh file, or the copy is too large. Files that the meshes refer to are left out, so the
/// caller must compare the copy with the world.
[[nodiscard]] Result<WorldCopy, std::string> copy_of_world(const FilePlace& sdf,
                                                           const std::vector<std::string>& meshes,
                                                           const std::string& written_out = {});

}  // namespace octoskin::sim
