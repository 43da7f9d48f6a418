// A world as files that lie in one folder and refer to nothing outside of it: for a recording.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::sim {

/// What a world may take in a recording. The largest of the shipped ones takes 0.1 MiB.
inline constexpr std::size_t kWorldBytesMax = std::size_t{16} << 20U;
inline constexpr std::size_t kMeshBytesMax = std::size_t{64} << 20U;
inline constexpr std::size_t kMeshesBytesMax = std::size_t{256} << 20U;  ///< of all together
inline constexpr std::size_t kMeshesMax = 99;

struct MeshCopy {
    std::string name;  ///< "mesh_01.stl"
    std::string bytes;
};

struct WorldCopy {
    std::string sdf;  ///< the same world, but that it names each mesh by its new name
    std::vector<MeshCopy> meshes;
    std::vector<std::string> left_out;  ///< the uris of meshes that it is without, each once
};

/// Reads the world's file and those of its meshes, each once. `meshes`: World::meshes(), the uris of those
/// that were read as shapes; any other file that the world calls a mesh, as of a collision, is left out, for
/// it may be any of yours. `written_out`: World::written_out(), taken in
/// place of a file that includes models. The error says why there can be no such copy: it includes models
/// all the same, a mesh cannot be read, has another ending than meshes have, or all of it is too large. What
/// the meshes refer to in their turn is left out: what is read from the copy has to be compared with the
/// world.
[[nodiscard]] Result<WorldCopy, std::string> copy_of_world(const FilePlace& sdf,
                                                           const std::vector<std::string>& meshes,
                                                           const std::string& written_out = {});

}  // namespace octoskin::sim
