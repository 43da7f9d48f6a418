#include "host/apps/recording/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <utility>

namespace octoskin {
namespace {

constexpr int kTries = 10;

bool is_same_file(int one, int other) {
    struct stat first {};
    struct stat second {};
    return ::fstat(one, &first) == 0 && ::fstat(other, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

}  // namespace

std::optional<FileLock> FileLock::lock(Descriptor descriptor, Kind kind) {
    const int operation = kind == Kind::shared ? LOCK_SH : LOCK_EX;
    int failed = ::flock(descriptor.get(), operation | LOCK_NB);
    while (failed != 0 && errno == EINTR) failed = ::flock(descriptor.get(), operation | LOCK_NB);
    if (failed != 0 && errno == EWOULDBLOCK) return std::nullopt;
    if (failed != 0) return of_nothing();
    return FileLock(std::move(descriptor));
}

std::optional<FileLock> FileLock::take(const FilePlace& file, Kind kind) {
    for (int tries = 0; tries < kTries; ++tries) {
        auto opened = file.open();
        if (!opened) return of_nothing();
        auto locked = lock(Descriptor(opened->release()), kind);
        if (!locked || locked->is_of(file)) return locked;
    }
    return std::nullopt;
}

std::optional<FileLock> FileLock::take(OpenFile opened, const FilePlace& file) {
    auto locked = lock(Descriptor(opened.release()), Kind::exclusive);
    return locked && locked->is_of(file) ? std::move(locked) : std::nullopt;
}

bool FileLock::is_of(const FilePlace& file) const {
    if (!descriptor_) return true;
    const auto again = file.open();
    return again && is_same_file(again->descriptor(), descriptor_.get());
}

std::optional<FileLock> FileLock::take(const OpenFolder& folder, Kind kind) {
    // Opened again: a lock belongs to one open file description, and the folder's own descriptor has
    // duplicates.
    Descriptor again(::openat(folder.descriptor(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!again) return of_nothing();
    return lock(std::move(again), kind);
}

}  // namespace octoskin
