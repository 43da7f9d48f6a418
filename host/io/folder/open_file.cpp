#include "host/io/folder/open_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace octoskin {

std::string other_kind_of(unsigned mode) {
    switch (mode & S_IFMT) {
        case S_IFREG:
            return {};
        case S_IFDIR:
            return "a directory";
        case S_IFIFO:
            return "a named pipe";
        case S_IFSOCK:
            return "a socket";
        case S_IFLNK:
            return "a symbolic link";
        default:
            return "a device";
    }
}

namespace {

/// A sparse file can be larger than the disk, and reading all of it can take hours. A file below this size is
/// read within seconds.
constexpr off_t kHolesMatter = off_t{1} << 30U;
/// Frames without content, copied by a tool that writes zeros as holes, have a larger share of data than
/// that.
constexpr off_t kBytesPerByteThere = 100;

/// Leaves the file position at the beginning. Without support of the file system there are no holes.
bool is_nearly_all_holes(int descriptor, off_t size) {
    if (size <= kHolesMatter) return false;
    off_t there = 0;
    off_t at = 0;
    while (at < size) {
        const off_t data = ::lseek(descriptor, at, SEEK_DATA);
        if (data < 0 && errno == ENXIO) break;
        at = data < 0 ? -1 : ::lseek(descriptor, data, SEEK_HOLE);
        there = at < 0 ? size : there + (at - data);
        if (there >= size / kBytesPerByteThere) break;
    }
    ::lseek(descriptor, 0, SEEK_SET);
    return there < size / kBytesPerByteThere;
}

}  // namespace

std::filesystem::path path_of_descriptor(int descriptor) {
    return fmt::format("/proc/self/fd/{}", descriptor);
}

std::filesystem::path OpenFile::path_for_libraries() const {
    return path_of_descriptor(descriptor_.get());
}

std::filesystem::path OpenFile::path_for_helpers() const {
    return fmt::format("/proc/{}/fd/{}", ::getpid(), descriptor_.get());
}

Result<std::string, FolderError> OpenFile::read(std::size_t bytes_max) const {
    constexpr std::size_t kPiece = 65'536;
    std::string bytes;
    while (bytes.size() <= bytes_max) {
        const std::size_t begin = bytes.size();
        const std::size_t piece = std::min(kPiece, bytes_max + 1 - begin);
        bytes.resize(begin + piece);
        ssize_t count = ::pread(descriptor_.get(), bytes.data() + begin, piece, static_cast<off_t>(begin));
        const int error = errno;
        bytes.resize(begin + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
        if (count < 0 && error != EINTR) return unexpected(folder_error_of(error, shown_));
        if (count == 0) break;
    }
    return bytes;
}

Result<OpenFile, FolderError> open_ordinary(const Descriptor& path, const std::filesystem::path& shown) {
    struct stat status {};
    if (::fstat(path.get(), &status) != 0) return unexpected(folder_error_of(errno, shown));
    if (std::string kind = other_kind_of(status.st_mode); !kind.empty())
        return unexpected(FolderError{FolderFault::not_a_file, shown, 0, std::move(kind)});
    Descriptor opened(::open(path_of_descriptor(path.get()).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!opened) return unexpected(folder_error_of(errno, shown));
    if (is_nearly_all_holes(opened.get(), status.st_size))
        return unexpected(FolderError{
            FolderFault::not_a_file, shown, 0,
            fmt::format("a file of {} bytes that consists almost only of holes", status.st_size)});
    return OpenFile(std::move(opened), shown);
}

}  // namespace octoskin
