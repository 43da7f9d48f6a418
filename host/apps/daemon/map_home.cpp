#include "host/apps/daemon/map_home.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include "host/apps/daemon/map_files.hpp"

namespace octoskin {
namespace {

/// Also one that a killed run has not put in its place.
bool has_map(const OpenFolder& folder) {
    if (folder.kind_of(FileSet::kReadyFolder) != EntryKind::absent) return true;
    for (const char* file : kMapFiles)
        if (folder.kind_of(file) != EntryKind::absent) return true;
    return false;
}

/// A folder that was moved still has a link count.
bool has_name(const OpenFolder& folder) {
    struct stat status {};
    return ::fstat(folder.descriptor(), &status) == 0 && status.st_nlink > 0;
}

/// From the kernel: by now its name may lead elsewhere.
std::filesystem::path path_of(const OpenFolder& folder) {
    std::error_code error;
    auto path = std::filesystem::read_symlink(folder.path_for_libraries(), error);
    return error ? std::filesystem::absolute(folder.shown()).lexically_normal() : path;
}

/// Opens an absolute path, if there is no link on the way.
Result<OpenFolder, FolderError> open_without_links(const std::filesystem::path& path) {
    const auto root = OpenFolder::open("/", FolderAccess::write);
    if (!root) return root;
    return path.relative_path().empty() ? root : root->open_folder(path.relative_path());
}

}  // namespace

MapHome::MapHome(std::filesystem::path named, FolderLock lock)
    : named_(std::move(named)), lock_(std::move(lock)), place_(path_of(lock_.folder())) {}

Result<MapHome, AppError> MapHome::take(const std::filesystem::path& named) {
    auto lock = FolderLock::take(named);
    if (!lock) return unexpected(lock.error());
    return MapHome(named, std::move(lock).value());
}

bool MapHome::look() {
    problem_.clear();
    if (is_in_its_place()) {
        if (!folder().is_still_there() && std::filesystem::absolute(named_).lexically_normal() != place_)
            problem_ =
                fmt::format("{}: leads elsewhere since octoskin started, and is not followed there; {}",
                            named_.string(), where_it_goes());
        return false;
    }
    const auto there = open_without_links(place_);
    if (!there && there.error().fault == FolderFault::absent) {
        problem_ = why_not_there();
        return false;
    }
    if (!there) {
        problem_ = fmt::format("the maps' folder was replaced while octoskin ran: {}; {}",
                               FolderLock::cannot_save(place_, there.error()).message(), where_it_goes());
        return false;
    }
    if (has_map(*there)) {  // not even locked: another daemon may be about to start with it
        problem_ = why_not_overwritten();
        return false;
    }
    auto next = FolderLock::take(*there, place_);
    if (!next) {
        problem_ = fmt::format("the maps' folder was replaced while octoskin ran: {}; {}",
                               next.error().message(), where_it_goes());
        return false;
    }
    if (has_map(*there)) {  // another octoskin put it there before the lock was taken
        problem_ = why_not_overwritten();
        return false;
    }
    lock_ = std::move(next).value();
    return true;
}

bool MapHome::is_in_its_place() const {
    const auto there = open_without_links(place_);
    struct stat held {};
    struct stat found {};
    return there && ::fstat(folder().descriptor(), &held) == 0 && ::fstat(there->descriptor(), &found) == 0 &&
           held.st_dev == found.st_dev && held.st_ino == found.st_ino;
}

std::string MapHome::where() const {
    return has_name(folder()) ? path_of(folder()).string() : std::string();
}

std::string MapHome::where_it_goes() const {
    const std::string now = where();
    return now.empty() ? "the map is not saved" : "the map is still saved in " + now;
}

std::string MapHome::why_not_overwritten() const {
    return fmt::format(
        "{}: this folder replaced the maps' folder while octoskin ran, and contains another map, which "
        "is not overwritten: move {} (and {}) out of it to have this map saved there; or end octoskin and "
        "start it again to continue with the other map; {}",
        place_.string(), kMapFilesText, FileSet::kReadyFolder, where_it_goes());
}

std::string MapHome::why_not_there() const {
    if (has_name(folder())) {
        return fmt::format(
            "{}: the maps' folder was moved away while octoskin ran; {}: move it back, or create an empty "
            "folder in its place to have the map saved there",
            place_.string(), where_it_goes());
    }
    return fmt::format(
        "{}: the maps' folder was removed while octoskin ran, and the map is not saved: create an empty "
        "folder in its place to have the map saved there",
        place_.string());
}

}  // namespace octoskin
