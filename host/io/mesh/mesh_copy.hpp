// A mesh file as it was at one moment: what is read is what was hashed, even if the file changes.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

inline constexpr std::uintmax_t kMeshBytesMax = std::uintmax_t{256} << 20U;

struct MeshCopy {
    std::string name;    ///< of the file, whose ending tells its format
    OpenFile bytes;      ///< in memory
    std::string sha256;  ///< of the bytes
};

/// Errors name the file: those of FilePlace::open, too_large.
[[nodiscard]] Result<MeshCopy, Error> copy_mesh(const FilePlace& file);
/// The digest alone, without a copy. The same errors; too_large also beyond `bytes_left`, which is reduced by
/// the file's size.
[[nodiscard]] Result<std::string, Error> mesh_sha256(const FilePlace& file, std::uintmax_t& bytes_left);

}  // namespace octoskin
