#include "host/apps/recording/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace octoskin {
namespace {

/// Whether the path still leads to what was opened: it may have been replaced before it was locked.
bool is_still_at(const std::filesystem::path& path, int descriptor) {
    struct stat opened {};
    struct stat there {};
    return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &there) == 0 &&
           opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

}  // namespace

std::optional<FileLock> FileLock::take(const std::filesystem::path& path, Kind kind) {
    constexpr int kTries = 10;
    for (int tries = 0; tries < kTries; ++tries) {
        // Without blocking: it may be a named pipe.
        const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
        if (descriptor < 0) return FileLock(-1);
        FileLock lock(descriptor);
        const int operation = kind == Kind::shared ? LOCK_SH : LOCK_EX;
        int failed = ::flock(descriptor, operation | LOCK_NB);
        while (failed != 0 && errno == EINTR) failed = ::flock(descriptor, operation | LOCK_NB);
        if (failed != 0 && errno == EWOULDBLOCK) return std::nullopt;
        if (failed != 0) return FileLock(-1);
        if (is_still_at(path, descriptor)) return lock;
    }
    return std::nullopt;
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock::~FileLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace octoskin
