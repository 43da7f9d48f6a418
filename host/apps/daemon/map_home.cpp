#include "host/apps/daemon/map_home.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

namespace octoskin {
namespace {

constexpr const char* kMapFiles[] = {"fused.ot", "fused.bt"};

bool has_map(const OpenFolder& folder) {
    for (const char* file : kMapFiles)
        if (folder.kind_of(file) != EntryKind::absent) return true;
    return false;
}

/// A folder that was moved still has a name, somewhere.
bool has_name(const OpenFolder& folder) {
    struct stat status {};
    return ::fstat(folder.descriptor(), &status) == 0 && status.st_nlink > 0;
}

std::string replaced(const std::string& why) {
    return "the maps' folder was replaced while octoskin ran, and its map is not saved by that name: " + why;
}

}  // namespace

Result<MapHome, AppError> MapHome::take(const std::filesystem::path& named) {
    auto lock = FolderLock::take(named);
    if (!lock) return unexpected(lock.error());
    return MapHome(named, std::move(lock).value());
}

bool MapHome::look() {
    problem_.clear();
    if (folder().is_still_there()) return false;
    std::error_code error;
    if (!std::filesystem::exists(named_, error)) {
        problem_ = why_not_there();
        return false;
    }
    const auto there = OpenFolder::open(named_, FolderAccess::write);
    if (!there) {
        problem_ = replaced(FolderLock::cannot_save(named_, there.error()).message);
        return false;
    }
    if (has_map(*there)) {  // not to be locked either: another daemon may be about to begin with it
        problem_ = fmt::format(
            "{}: this folder took the place of the maps' folder while octoskin ran, and has a map of its "
            "own, "
            "which is not overwritten: move fused.ot and fused.bt out of it, and this map is saved there; or "
            "end octoskin and start it again to go on with that one",
            named_.string());
        return false;
    }
    auto next = FolderLock::take(*there, named_);
    if (!next) {
        problem_ = replaced(next.error().message);
        return false;
    }
    lock_ = std::move(next).value();
    return true;
}

std::string MapHome::why_not_there() const {
    if (has_name(folder())) {
        return fmt::format(
            "{}: the maps' folder was moved away while octoskin ran; maps go on being saved in it, where it "
            "is "
            "now: move it back, or make an empty folder in its place, and they are saved there",
            named_.string());
    }
    return fmt::format(
        "{}: the maps' folder was removed while octoskin ran, and the map is not saved: make an empty folder "
        "in "
        "its place, and it is saved there",
        named_.string());
}

}  // namespace octoskin
