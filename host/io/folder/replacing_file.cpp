#include "host/io/folder/replacing_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace octoskin {
namespace {

/// The temporary name of a file before it is put into place.
std::string beside(const std::string& name) {
    return "." + name + ".octoskin-part";
}

Unexpected<FolderError> taken(const OpenFolder& folder, const std::string& name, EntryKind kind) {
    const int why = kind == EntryKind::folder ? EISDIR : EEXIST;
    return unexpected(FolderError{FolderFault::is_there, folder.shown(name), why});
}

Status<FolderError> check_places(const OpenFolder& folder, const std::string& name) {
    const EntryKind there = folder.kind_of(name);
    if (there == EntryKind::folder || there == EntryKind::other) return taken(folder, name, there);
    const std::string part = beside(name);
    if (folder.kind_of(part) == EntryKind::folder) return taken(folder, part, EntryKind::folder);
    if (::faccessat(folder.descriptor(), ".", W_OK | X_OK, AT_EACCESS) != 0)
        return unexpected(folder_error_of(errno, folder.shown()));
    return Done{};
}

/// Refuses a path that names a folder.
Status<FolderError> check_name(const FilePlace& file) {
    const std::string name = file.filename();
    if (!name.empty() && name != "." && name != "..") return Done{};
    return unexpected(FolderError{FolderFault::is_there, file.shown(), EISDIR});
}

/// Copies the mode of the caller's own old file. The mode of another user's file would determine who may
/// write to the new one.
void keep_mode(const OpenFolder& folder, const std::string& name, int descriptor) {
    struct stat old {};
    constexpr mode_t kPermissions = 0777;
    const bool is_there =
        ::fstatat(folder.descriptor(), name.c_str(), &old, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(old.st_mode);
    if (is_there && old.st_uid == ::geteuid())
        static_cast<void>(::fchmod(descriptor, old.st_mode & kPermissions));
}

}  // namespace

Status<FolderError> ReplacingFile::check(const FilePlace& file) {
    if (auto named = check_name(file); !named) return named;
    const auto folder = file.parent_to_write();
    if (!folder) return unexpected(folder.error());
    return check_places(*folder, file.filename());
}

Result<ReplacingFile, FolderError> ReplacingFile::begin(const FilePlace& file) {
    if (const auto named = check_name(file); !named) return unexpected(named.error());
    auto folder = file.parent_to_write();
    if (!folder) return unexpected(folder.error());
    const std::string name = file.filename();
    if (const auto checked = check_places(*folder, name); !checked) return unexpected(checked.error());
    // A remainder of a killed process, or a trap: it is removed; the target of a link stays unchanged.
    if (const auto removed = folder->remove(beside(name)); !removed) return unexpected(removed.error());
    auto created = folder->create_new(beside(name));
    if (!created) return unexpected(created.error());
    keep_mode(*folder, name, created->descriptor());
    return ReplacingFile(std::move(*folder), name, std::move(*created));
}

ReplacingFile::ReplacingFile(OpenFolder folder, std::string name, OpenFile file)
    : folder_(std::move(folder)), name_(std::move(name)), file_(std::move(file)) {}

ReplacingFile::~ReplacingFile() {
    if (file_ && file_->descriptor() >= 0) static_cast<void>(folder_.remove(beside(name_)));
}

Status<FolderError> ReplacingFile::commit() {
    // Network file systems may report a write error only at close.
    if (::close(file_->release()) != 0) {
        const int error = errno;
        static_cast<void>(folder_.remove(beside(name_)));
        return unexpected(folder_error_of(error, folder_.shown(name_)));
    }
    if (auto moved = folder_.move(beside(name_), name_); !moved) {
        static_cast<void>(folder_.remove(beside(name_)));
        return moved;
    }
    return Done{};
}

}  // namespace octoskin
