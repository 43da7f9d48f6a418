#include "host/bridge/mcap/output_room.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <cerrno>
#include <string>
#include <vector>

namespace octoskin::bridge {
namespace {

/// A file that cannot be looked at counts as empty.
std::uint64_t bytes_below(const OpenFolder& folder) {
    const auto names = folder.names();
    std::uint64_t bytes = 0;
    for (const std::string& name : names ? *names : std::vector<std::string>()) {
        struct stat status {};
        if (::fstatat(folder.descriptor(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0) continue;
        if (S_ISREG(status.st_mode)) bytes += static_cast<std::uint64_t>(status.st_size);
        if (!S_ISDIR(status.st_mode)) continue;
        if (const auto below = folder.open_folder(name)) bytes += bytes_below(*below);
    }
    return bytes;
}

}  // namespace

std::uint64_t OutputRoom::bytes_max(std::uint64_t bag_bytes) noexcept {
    constexpr std::uint64_t kMax = 64 * 1024 * kMiB;
    constexpr std::uint64_t kTimes = 1000;
    return std::min(kMax, kTimes * std::min(bag_bytes, kMax) + 256 * kMiB);
}

Status<Error> OutputRoom::check(std::uint64_t produced) {
    if (produced - measured_at_ < kPieceBytes) return Done{};
    measured_at_ = produced;
    const auto use = measure_();
    if (!use) return unexpected(use.error());
    if (use->bytes > bytes_max_)
        return unexpected(Error{
            .code = ErrorCode::limit_exceeded,
            .what = fmt::format("the recording of this bag would be larger than {} MiB, a thousand times "
                                "the bag and 256 MiB, or 64 GiB",
                                bytes_max_ / kMiB),
            .remedy = "split the bag; one that is small for what it becomes may be hostile"});
    if (use->free < kFreeBytesMin)
        return unexpected(Error{
            .code = ErrorCode::limit_exceeded,
            .what = fmt::format("less than {} MiB are left on the file system", kFreeBytesMin / kMiB),
            .remedy =
                "make room, or name a folder on another file system (for `octoskin replay` with TMPDIR)"});
    return Done{};
}

Result<OutputRoom::Use, Error> use_of(const OpenFolder& folder) {
    struct statvfs system {};
    if (::fstatvfs(folder.descriptor(), &system) != 0)
        return unexpected(to_error(folder_error_of(errno, folder.shown())));
    return OutputRoom::Use{.bytes = bytes_below(folder),
                           .free = std::uint64_t{system.f_bavail} * std::uint64_t{system.f_frsize}};
}

}  // namespace octoskin::bridge
