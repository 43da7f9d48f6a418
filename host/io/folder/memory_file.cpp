#include "host/io/folder/memory_file.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace octoskin {

Result<MemoryFile, FolderError> MemoryFile::make(std::filesystem::path shown) {
    Descriptor made(::memfd_create("octoskin", MFD_CLOEXEC));
    if (!made) return unexpected(folder_error_of(errno, shown));
    return MemoryFile(OpenFile(std::move(made), std::move(shown)));
}

bool MemoryFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file_.descriptor(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

Result<OpenFile, FolderError> MemoryFile::opened() && {
    if (::lseek(file_.descriptor(), 0, SEEK_SET) != 0)
        return unexpected(folder_error_of(errno, file_.shown()));
    return std::move(file_);
}

}  // namespace octoskin
