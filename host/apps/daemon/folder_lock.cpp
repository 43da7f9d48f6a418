#include "host/apps/daemon/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

constexpr unsigned kMode = 0600;  // others could lock a file that they can open
constexpr int kTries = 10;

/// The process id that the holder wrote; empty if it could not.
std::string holder_of(int descriptor) {
    std::array<char, 32> text{};
    const ssize_t count = ::pread(descriptor, text.data(), text.size(), 0);
    return count > 0 ? " (process " + std::string(text.data(), static_cast<std::size_t>(count)) + ")"
                     : std::string();
}

/// In a folder of another user, a lock file of root's would keep that user's octoskin out for ever.
void give_to_owner(const OpenFile& file, const OpenFolder& folder) {
    struct stat status {};
    if (::geteuid() != 0 || ::fstat(folder.descriptor(), &status) != 0) return;
    (void)!::fchown(file.descriptor(), status.st_uid, status.st_gid);
}

Result<OpenFile, FolderError> open_or_create(const OpenFolder& folder) {
    auto opened = folder.open_file(FolderLock::kFile);
    if (opened || opened.error().fault != FolderFault::absent) return opened;
    auto created = folder.create_new(FolderLock::kFile, kMode);
    if (created) give_to_owner(*created, folder);
    if (created || created.error().fault != FolderFault::is_there) return created;
    return folder.open_file(FolderLock::kFile);  // another process was faster
}

/// For a file with no other name, so that no other file is written.
void write_process_id(const OpenFile& file) {
    const std::string own = std::to_string(::getpid());
    const Descriptor to_write(::open(file.path_for_libraries().c_str(), O_WRONLY | O_CLOEXEC));
    if (!to_write) return;
    // On a full disk the id is missing: only the lock matters.
    (void)!::ftruncate(to_write.get(), 0);
    (void)!::pwrite(to_write.get(), own.data(), own.size(), 0);
}

}  // namespace

AppError FolderLock::cannot_save(const std::filesystem::path& folder, const FolderError& error) {
    if (error.fault == FolderFault::link || error.fault == FolderFault::not_a_file)
        return cannot_create(error.path, error.reason()).error;
    const std::string remedy = error.fault == FolderFault::foreign_owner
                                   ? std::string()
                                   : ": " + remedy_of({error.error_number, std::generic_category()});
    return cannot_create(folder, "no maps can be saved there (" + error.reason() + ")" + remedy +
                                     "; --maps names the folder")
        .error;
}

Result<FolderLock, AppError> FolderLock::take(const std::filesystem::path& named) {
    const auto made = make_open_folder(named);
    if (!made) return unexpected(cannot_save(named, made.error()));
    return take(made->folder, named);
}

Result<FolderLock, AppError> FolderLock::take(const OpenFolder& folder, const std::filesystem::path& named) {
    for (int tries = 0; tries < kTries; ++tries) {
        auto file = open_or_create(folder);
        if (!file) return unexpected(cannot_save(named / kFile, file.error()));
        if (::flock(file->descriptor(), LOCK_EX | LOCK_NB) != 0) {
            return cannot_create(named, "another octoskin" + holder_of(file->descriptor()) +
                                            " saves its map there; stop it, or name another folder");
        }
        struct stat status {};
        if (::fstat(file->descriptor(), &status) != 0)
            return unexpected(cannot_save(named, folder_error_of(errno, named)));
        if (status.st_nlink == 1) {
            (void)::fchmod(file->descriptor(), kMode);  // a file of an earlier version, or a copied one
            write_process_id(*file);
            return FolderLock(folder, std::move(*file));
        }
        // A file with several names, or none any more, is left as it is; a new one replaces it.
        if (status.st_nlink > 1) {
            if (const auto removed = folder.remove(FolderLock::kFile); !removed)
                return unexpected(cannot_save(named, removed.error()));
        }
    }
    return cannot_create(
        named,
        "its lock file is replaced again and again; look for another program that works in this folder");
}

}  // namespace octoskin
