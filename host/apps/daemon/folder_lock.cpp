#include "host/apps/daemon/folder_lock.hpp"

#include <spdlog/spdlog.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/recording/text_file.hpp"

namespace octoskin {
namespace {

constexpr unsigned kMode = 0600;  // others could lock a file that they can open
constexpr int kTries = 10;

}  // namespace

/// The files of a killed run are moved before the map is read: later they would replace the daemon's.
Result<FolderLock, AppError> FolderLock::settled(FolderLock lock) {
    const auto is_moved = settle_file_set_of_daemon(lock.folder());
    if (!is_moved) return unexpected(is_moved.error());
    if (*is_moved)
        spdlog::warn("{}: the files that a killed octoskin left half moved are in their places",
                     lock.folder().shown().string());
    return lock;
}

AppError FolderLock::cannot_save(const std::filesystem::path& folder, const FolderError& error) {
    if (error.fault == FolderFault::link || error.fault == FolderFault::not_a_file)
        return cannot_create(error.path, to_error(error)).error;
    Error refused = to_error(error, "no maps can be saved there: ");
    if (error.fault != FolderFault::foreign_owner)
        refused.remedy = remedy_of({error.error_number, std::generic_category()});
    refused.remedy += "; --maps names the folder";
    return cannot_create(folder, std::move(refused)).error;
}

Result<FolderLock, AppError> FolderLock::take(const std::filesystem::path& named) {
    const auto made = make_open_folder(named);
    if (!made) return unexpected(cannot_save(named, made.error()));
    return take(made->folder, named);
}

Result<FolderLock, AppError> FolderLock::take(const OpenFolder& folder, const std::filesystem::path& named) {
    for (int tries = 0; tries < kTries; ++tries) {
        auto opened = open_daemons_lock(folder);
        if (!opened) return unexpected(cannot_save(named / kFile, opened.error()));
        OpenFile& file = opened->file;
        if (::flock(file.descriptor(), LOCK_EX | LOCK_NB) != 0) {
            return cannot_create(
                named, {.code = ErrorCode::in_use,
                        .what = "another octoskin" + holder_of(file) +
                                " writes maps there (octoskin run, or octoskin replay at its end)",
                        .remedy = "stop it or wait until it ends, or name another folder with --maps"});
        }
        struct stat status {};
        if (::fstat(file.descriptor(), &status) != 0)
            return unexpected(cannot_save(named, folder_error_of(errno, named)));
        if (status.st_nlink == 1) {
            (void)::fchmod(file.descriptor(), kMode);  // a file of an earlier version, or a copied one
            write_holder(file);
            return settled(FolderLock(folder, std::move(file)));
        }
        // A file with several names, or none any more, is left as it is; a new one replaces it.
        if (status.st_nlink > 1) {
            if (const auto removed = folder.remove(FolderLock::kFile); !removed)
                return unexpected(cannot_save(named, removed.error()));
        }
    }
    return cannot_create(named, {.code = ErrorCode::in_use,
                                 .what = "its lock file is replaced again and again",
                                 .remedy = "look for another program that works in this folder"});
}

}  // namespace octoskin
