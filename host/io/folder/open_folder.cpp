#include "host/io/folder/open_folder.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <pwd.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr int kFolderFlags = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
/// Octoskin's own folders are less deep.
constexpr int kDepthMax = 32;

Unexpected<FolderError> errno_error(int error_number, const fs::path& path) {
    return unexpected(folder_error_of(error_number, path));
}

Status<FolderError> done_or_errno(int result, const fs::path& path) {
    if (result == 0) return Done{};
    return errno_error(errno, path);
}

std::string name_of_user(uid_t user) {
    std::array<char, 4096> room{};
    passwd entry{};
    passwd* found = nullptr;
    if (::getpwuid_r(user, &entry, room.data(), room.size(), &found) == 0 && found != nullptr)
        return fmt::format("{} (uid {})", entry.pw_name, user);
    return fmt::format("uid {}", user);
}

/// The sorted names; reads the descriptor to its end.
Result<std::vector<std::string>, FolderError> names_in(Descriptor folder, const fs::path& shown) {
    DIR* const stream = ::fdopendir(folder.get());
    if (stream == nullptr) return errno_error(errno, shown);
    static_cast<void>(folder.release());  // owned by the stream from here on
    std::vector<std::string> names;
    errno = 0;
    for (const dirent* entry = ::readdir(stream); entry != nullptr; entry = ::readdir(stream)) {
        const std::string name = entry->d_name;
        if (name != "." && name != "..") names.push_back(name);
        errno = 0;
    }
    const int error = errno;
    ::closedir(stream);
    if (error != 0) return errno_error(error, shown);
    std::sort(names.begin(), names.end());
    return names;
}

Status<FolderError> remove_tree(int folder, const std::string& leaf, const fs::path& shown, int depth) {
    if (::unlinkat(folder, leaf.c_str(), 0) == 0 || errno == ENOENT) return Done{};
    if (errno != EISDIR && errno != EPERM) return errno_error(errno, shown);
    const int why = errno;
    Descriptor opened(::openat(folder, leaf.c_str(), kFolderFlags | O_NOFOLLOW));
    if (!opened) return errno_error(errno == ENOTDIR || errno == ELOOP ? why : errno, shown);
    if (depth >= kDepthMax) return errno_error(ENAMETOOLONG, shown);
    const int within = opened.get();
    Descriptor listed(::fcntl(within, F_DUPFD_CLOEXEC, 0));
    if (!listed) return errno_error(errno, shown);
    const auto names = names_in(std::move(listed), shown);
    if (!names) return unexpected(names.error());
    for (const std::string& name : *names) {
        if (const auto removed = remove_tree(within, name, shown / name, depth + 1); !removed) return removed;
    }
    return done_or_errno(::unlinkat(folder, leaf.c_str(), AT_REMOVEDIR), shown);
}

}  // namespace

OpenFolder::OpenFolder(Descriptor descriptor, fs::path shown, FolderAccess access, OpenAt2 openat2)
    : access_(access) {
    auto base = std::make_shared<Base>();
    base->descriptor = descriptor.get();
    base->owner = std::move(descriptor);
    base->shown = std::move(shown);
    base->openat2 = openat2;
    base_ = std::move(base);
}

Result<OpenFolder, FolderError> OpenFolder::checked(Descriptor descriptor, fs::path shown,
                                                    FolderAccess access, OpenAt2 openat2) {
    if (access == FolderAccess::write) {
        struct stat status {};
        if (::fstat(descriptor.get(), &status) != 0) return errno_error(errno, shown);
        const uid_t caller = ::geteuid();
        const bool is_ours = status.st_uid == caller || status.st_uid == 0 || caller == 0;
        if (!is_ours) {
            return unexpected(
                FolderError{FolderFault::foreign_owner, shown, EPERM, name_of_user(status.st_uid)});
        }
    }
    return OpenFolder(std::move(descriptor), std::move(shown), access, openat2);
}

Result<OpenFolder, FolderError> OpenFolder::open(const fs::path& typed, FolderAccess access,
                                                 OpenAt2 openat2) {
    const fs::path named = typed.empty() ? fs::path(".") : typed;
    Descriptor opened(::open(named.c_str(), kFolderFlags));
    if (!opened) return errno_error(errno, typed);
    return checked(std::move(opened), typed, access, openat2);
}

Result<OpenFolder, FolderError> OpenFolder::to_write() const {
    Descriptor same(::fcntl(base_->descriptor, F_DUPFD_CLOEXEC, 0));
    if (!same) return errno_error(errno, shown());
    return checked(std::move(same), shown(), FolderAccess::write, base_->openat2);
}

fs::path OpenFolder::path_for_libraries() const {
    return path_of_descriptor(base_->descriptor);
}

bool OpenFolder::is_still_there() const {
    struct stat opened {};
    struct stat there {};
    const fs::path named = shown().empty() ? fs::path(".") : shown();
    return ::fstat(base_->descriptor, &opened) == 0 && ::stat(named.c_str(), &there) == 0 &&
           opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

EntryKind OpenFolder::kind_of(const fs::path& name) const {
    const auto plain = name_beneath(shown(), name);
    if (!plain) return EntryKind::other;
    const auto opened = open_beneath(*base_, *plain, O_PATH);
    if (!opened) {
        const FolderFault fault = opened.error().fault;
        if (fault == FolderFault::link) return EntryKind::link;
        const bool is_absent = fault == FolderFault::absent || fault == FolderFault::not_a_folder;
        return is_absent ? EntryKind::absent : EntryKind::other;
    }
    struct stat status {};
    if (::fstat(opened->get(), &status) != 0) return EntryKind::other;
    if (S_ISLNK(status.st_mode)) return EntryKind::link;
    if (S_ISDIR(status.st_mode)) return EntryKind::folder;
    return S_ISREG(status.st_mode) ? EntryKind::file : EntryKind::other;
}

Result<std::vector<std::string>, FolderError> OpenFolder::names() const {
    // Opened again: a second reader of the same descriptor would continue where the first one ended.
    Descriptor again(::openat(base_->descriptor, ".", kFolderFlags));
    if (!again) return errno_error(errno, shown());
    return names_in(std::move(again), shown());
}

Result<OpenFile, FolderError> OpenFolder::open_file(const fs::path& name) const {
    const auto plain = name_beneath(shown(), name);
    if (!plain) return unexpected(plain.error());
    const auto path = open_beneath(*base_, *plain, O_PATH);
    if (!path) return unexpected(path.error());
    return open_ordinary(*path, shown(name));
}

Result<OpenFolder, FolderError> OpenFolder::open_folder(const fs::path& name) const {
    const auto plain = name_beneath(shown(), name);
    if (!plain) return unexpected(plain.error());
    auto opened = open_beneath(*base_, *plain, kFolderFlags);
    if (!opened) return unexpected(opened.error());
    return checked(std::move(*opened), shown(name), access_, base_->openat2);
}

Result<OpenFolder::Spot, FolderError> OpenFolder::spot(const fs::path& name) const {
    assert(access_ == FolderAccess::write);
    const auto plain = name_beneath(shown(), name);
    if (!plain) return unexpected(plain.error());
    const auto slash = plain->rfind('/');
    if (slash == std::string::npos) {
        Descriptor same(::fcntl(base_->descriptor, F_DUPFD_CLOEXEC, 0));
        if (!same) return errno_error(errno, shown());
        return Spot{std::move(same), *plain, shown(*plain)};
    }
    const auto within = open_folder(plain->substr(0, slash));  // it checks the owner
    if (!within) return unexpected(within.error());
    Descriptor same(::fcntl(within->descriptor(), F_DUPFD_CLOEXEC, 0));
    if (!same) return errno_error(errno, shown());
    return Spot{std::move(same), plain->substr(slash + 1), shown(*plain)};
}

Result<OpenFile, FolderError> OpenFolder::create_new(const fs::path& name, unsigned mode) const {
    const auto at = spot(name);
    if (!at) return unexpected(at.error());
    const FolderBase within{at->folder.get(), at->shown.parent_path(), base_->openat2};
    auto created = open_beneath(within, at->leaf, O_RDWR | O_CREAT | O_EXCL, mode);
    if (!created) return unexpected(created.error());
    return OpenFile(std::move(*created), shown(name));
}

Status<FolderError> OpenFolder::make_folder(const fs::path& name) const {
    const auto at = spot(name);
    if (!at) return unexpected(at.error());
    return done_or_errno(::mkdirat(at->folder.get(), at->leaf.c_str(), 0777), at->shown);
}

Status<FolderError> OpenFolder::move(const fs::path& from, const fs::path& to) const {
    const auto source = spot(from);
    if (!source) return unexpected(source.error());
    const auto target = spot(to);
    if (!target) return unexpected(target.error());
    return done_or_errno(
        ::renameat(source->folder.get(), source->leaf.c_str(), target->folder.get(), target->leaf.c_str()),
        target->shown);
}

Status<FolderError> OpenFolder::link(const fs::path& from, const fs::path& to) const {
    const auto source = spot(from);
    if (!source) return unexpected(source.error());
    const auto target = spot(to);
    if (!target) return unexpected(target.error());
    return done_or_errno(
        ::linkat(source->folder.get(), source->leaf.c_str(), target->folder.get(), target->leaf.c_str(), 0),
        target->shown);
}

Status<FolderError> OpenFolder::remove(const fs::path& name) const {
    const auto at = spot(name);
    if (!at) return unexpected(at.error());
    if (::unlinkat(at->folder.get(), at->leaf.c_str(), 0) == 0 || errno == ENOENT) return Done{};
    return errno_error(errno, at->shown);
}

Status<FolderError> OpenFolder::remove_all(const fs::path& name) const {
    const auto at = spot(name);
    if (!at) return unexpected(at.error());
    return remove_tree(at->folder.get(), at->leaf, at->shown, 0);
}

Status<FolderError> OpenFolder::remove_empty(const fs::path& name) const {
    const auto at = spot(name);
    if (!at) return unexpected(at.error());
    return done_or_errno(::unlinkat(at->folder.get(), at->leaf.c_str(), AT_REMOVEDIR), at->shown);
}

Status<FolderError> OpenFolder::flush() const {
    return done_or_errno(::fsync(base_->descriptor), shown());
}

Status<FolderError> OpenFolder::flush(const fs::path& name) const {
    const auto file = open_file(name);
    if (!file) return unexpected(file.error());
    return done_or_errno(::fsync(file->descriptor()), file->shown());
}

Result<MadeFolder, FolderError> make_open_folder(const fs::path& typed, Parents parents) {
    std::error_code error;
    // An existing folder is opened: mkdir would not follow a typed link.
    const bool is_there = fs::exists(typed, error);
    bool is_new = false;
    if (!is_there && !error) {
        is_new = parents == Parents::are_made ? fs::create_directories(typed, error)
                                              : fs::create_directory(typed, error);
        if (error) return errno_error(error.value(), typed);
    }
    auto folder = OpenFolder::open(typed, FolderAccess::write);
    if (!folder) return unexpected(folder.error());
    return MadeFolder{std::move(*folder), is_new};
}

}  // namespace octoskin
