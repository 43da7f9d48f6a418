#include "host/io/mesh/mesh_copy.hpp"

#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <utility>

#include "host/io/digest/sha256.hpp"
#include "host/io/folder/memory_file.hpp"

namespace octoskin {
namespace {

/// Calls `take` with each part of the file, until it returns false, with errno.
template <class Take>
Status<Error> read_parts(const FilePlace& file, Take take) {
    const auto failed = [&file](Error error) { return unexpected(in_file(std::move(error), file.shown())); };
    const auto opened = file.open();
    if (!opened) return failed(to_error(opened.error(), "cannot be read: "));
    std::string part(1U << 20U, '\0');
    std::uintmax_t size = 0;
    for (;;) {
        const ssize_t count = ::read(opened->descriptor(), part.data(), part.size());
        if (count < 0 && errno == EINTR) continue;
        if (count == 0) return Done{};
        if (count > 0) size += static_cast<std::uintmax_t>(count);
        if (size > kMeshBytesMax)
            return failed({ErrorCode::too_large, "expected a mesh file of at most 256 MiB", "more"});
        if (count < 0 || !take(std::string_view(part).substr(0, static_cast<std::size_t>(count))))
            return failed(to_error(folder_error_of(errno, file.shown()), "cannot be read: "));
    }
}

}  // namespace

Result<MeshCopy, Error> copy_mesh(const FilePlace& file) {
    const auto failed = [&file](const FolderError& error) {
        return unexpected(in_file(to_error(error, "cannot be read: "), file.shown()));
    };
    auto copy = MemoryFile::make(file.shown());
    if (!copy) return failed(copy.error());
    Sha256 digest;
    const auto read = read_parts(file, [&](std::string_view part) {
        digest.add(part);
        return copy->write(part);
    });
    if (!read) return unexpected(read.error());
    auto bytes = std::move(*copy).opened();
    if (!bytes) return failed(bytes.error());
    return MeshCopy{file.filename(), *std::move(bytes), digest.hexadecimal()};
}

Result<std::string, Error> mesh_sha256(const FilePlace& file, std::uintmax_t& bytes_left) {
    Sha256 digest;
    bool has_room = true;
    const auto read = read_parts(file, [&](std::string_view part) {
        has_room = part.size() <= bytes_left;
        if (!has_room) return false;
        bytes_left -= part.size();
        digest.add(part);
        return true;
    });
    if (!has_room)
        return unexpected(in_file({ErrorCode::too_large, "expected meshes of at most 1 GiB together", "more"},
                                  file.shown()));
    if (!read) return unexpected(read.error());
    return digest.hexadecimal();
}

}  // namespace octoskin
