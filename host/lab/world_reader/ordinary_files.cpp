#include "host/lab/world_reader/ordinary_files.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <mutex>
#include <string_view>

#include "hw/rigfile/file_kind.hpp"

namespace octoskin::sim {
namespace {

struct Refused {
    std::mutex mutex;
    std::string text;
};

/// A function-local static: the libraries open files before main() begins.
Refused& refused() {
    static Refused one;
    return one;
}

std::FILE* refuse(const char* path, std::string_view kind) {
    const std::scoped_lock lock(refused().mutex);
    if (refused().text.empty()) refused().text = std::string(path) + ", which is " + std::string(kind);
    errno = EINVAL;
    return nullptr;
}

std::FILE* open_ordinary(const char* path, const char* mode) {
    if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) {
        errno = EROFS;
        return nullptr;
    }
    if (const auto kind = rig::other_than_a_file(path); !kind.empty()) return refuse(path, kind);
    // The file may have been replaced since the check.
    const int file = ::open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) return nullptr;
    struct stat status {};
    if (::fstat(file, &status) == 0 && S_ISREG(status.st_mode)) return ::fdopen(file, "r");
    ::close(file);
    return refuse(path, "no ordinary file");
}

}  // namespace

std::string refused_file() {
    const std::scoped_lock lock(refused().mutex);
    return refused().text;
}

}  // namespace octoskin::sim

// These replace the C library's functions for this program and for every library that it loads.
extern "C" {
[[gnu::visibility("default")]] std::FILE* fopen(const char* path, const char* mode) {
    return octoskin::sim::open_ordinary(path, mode);
}
[[gnu::visibility("default")]] std::FILE* fopen64(const char* path, const char* mode) {
    return octoskin::sim::open_ordinary(path, mode);
}
}
