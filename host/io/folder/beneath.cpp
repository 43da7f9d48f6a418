#include "host/io/folder/beneath.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>

#include <cerrno>
#include <utility>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

Unexpected<FolderError> failure(int error_number, const fs::path& path) {
    return unexpected(folder_error_of(error_number, path));
}

bool is_link(int folder, const char* name) {
    struct stat status {};
    return ::fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(status.st_mode);
}

/// Opens one component. With O_PATH, O_NOFOLLOW alone would open a link itself.
Result<Descriptor, FolderError> open_component(int folder, const std::string& name, const fs::path& shown,
                                               int flags, unsigned mode) {
    Descriptor opened(::openat(folder, name.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, mode));
    const int error = errno;
    if (!opened) {
        const bool is_refused_link = error != EEXIST && is_link(folder, name.c_str());
        if (is_refused_link) return unexpected(FolderError{FolderFault::link, shown, ELOOP});
        return failure(error, shown);
    }
    struct stat status {};
    if ((flags & O_PATH) != 0 && ::fstat(opened.get(), &status) == 0 && S_ISLNK(status.st_mode))
        return unexpected(FolderError{FolderFault::link, shown, ELOOP});
    return opened;
}

/// Opens component after component, each relative to the previous one.
Result<Descriptor, FolderError> walk(const FolderBase& base, const std::string& name, int flags,
                                     unsigned mode) {
    Descriptor folder;
    int at = base.descriptor;
    fs::path shown = base.shown;
    std::string_view rest = name;
    for (auto slash = rest.find('/'); slash != std::string_view::npos; slash = rest.find('/')) {
        const std::string component(rest.substr(0, slash));
        shown /= component;
        auto next = open_component(at, component, shown, O_PATH | O_DIRECTORY, 0);
        if (!next) return next;
        folder = std::move(*next);
        at = folder.get();
        rest.remove_prefix(slash + 1);
    }
    return open_component(at, std::string(rest), shown / rest, flags, mode);
}

}  // namespace

int system_openat2(int folder, const char* name, const open_how& how) {
    return static_cast<int>(::syscall(SYS_openat2, folder, name, &how, sizeof how));
}

FolderError folder_error_of(int error_number, const fs::path& path) {
    const auto fault = [error_number] {
        switch (error_number) {
            case ENOENT:
                return FolderFault::absent;
            case EEXIST:
                return FolderFault::is_there;
            case ENOTDIR:
                return FolderFault::not_a_folder;
            case EACCES:
            case EPERM:
                return FolderFault::not_permitted;
            default:
                return FolderFault::system;
        }
    };
    return {fault(), path, error_number};
}

Result<std::string, FolderError> name_beneath(const fs::path& shown, const fs::path& name) {
    std::string plain = name.lexically_normal().string();
    while (plain.ends_with('/') && plain.size() > 1) plain.pop_back();
    const bool is_beneath = !plain.empty() && plain != "." && plain != ".." && !plain.starts_with("../") &&
                            name.is_relative() && plain.find('\0') == std::string::npos;
    if (!is_beneath) return unexpected(FolderError{FolderFault::outside, shown / name, EXDEV});
    return plain;
}

Result<Descriptor, FolderError> open_beneath(const FolderBase& base, const std::string& name, int flags,
                                             unsigned mode) {
    open_how how{};
    // Not O_NOFOLLOW: with O_PATH it would open a link itself instead of refusing it.
    how.flags = static_cast<decltype(how.flags)>(flags | O_CLOEXEC);
    how.mode = (flags & O_CREAT) != 0 ? mode : 0;
    how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS;
    Descriptor opened(base.openat2(base.descriptor, name.c_str(), how));
    if (opened) return opened;
    // On any error the walk, which applies the same rules, finds the component at fault.
    return walk(base, name, flags, mode);
}

}  // namespace octoskin
