#include "host/io/folder/file_place.hpp"

#include <fcntl.h>

#include <cerrno>
#include <mutex>
#include <utility>

#include "host/io/folder/memory_file.hpp"

namespace octoskin {

namespace fs = std::filesystem;

struct NamedFolder::State {
    fs::path shown;
    FilePlace place;  ///< the place to open, if it is not open yet
    std::mutex mutex;
    std::optional<OpenFolder> opened;
};

NamedFolder::NamedFolder(fs::path typed) : NamedFolder(FilePlace(std::move(typed))) {}

NamedFolder::NamedFolder(OpenFolder opened) : state_(new State{opened.shown(), {}, {}, std::move(opened)}) {}

NamedFolder::NamedFolder(FilePlace place)
    : state_(new State{place.shown(), std::move(place), {}, std::nullopt}) {}

const fs::path& NamedFolder::shown() const noexcept {
    return state_->shown;
}

Result<OpenFolder, FolderError> NamedFolder::open() const {
    const std::lock_guard lock(state_->mutex);
    if (!state_->opened) {
        auto opened = state_->place.open_folder();
        if (!opened) return opened;
        state_->opened.emplace(std::move(*opened));
    }
    return *state_->opened;
}

FilePlace FilePlace::held(std::string content, FilePlace place) {
    place.held_ = std::make_shared<const std::string>(std::move(content));
    return place;
}

EntryKind FilePlace::kind() const {
    if (held_) return EntryKind::file;
    if (folder_) {
        const auto folder = folder_->open();
        if (folder) return folder->kind_of(name_);
        const FolderFault fault = folder.error().fault;
        const bool is_absent = fault == FolderFault::absent || fault == FolderFault::not_a_folder;
        return is_absent ? EntryKind::absent : EntryKind::other;
    }
    std::error_code error;
    const auto status = fs::status(name_, error);
    switch (status.type()) {
        case fs::file_type::not_found:
            return EntryKind::absent;
        case fs::file_type::regular:
            return EntryKind::file;
        case fs::file_type::directory:
            return EntryKind::folder;
        case fs::file_type::none:  // it cannot be examined: a name that is too long counts as absent
            return error == std::errc::permission_denied ? EntryKind::other : EntryKind::absent;
        case fs::file_type::symlink:
        case fs::file_type::block:
        case fs::file_type::character:
        case fs::file_type::fifo:
        case fs::file_type::socket:
        case fs::file_type::unknown:
            break;
    }
    return EntryKind::other;
}

Result<OpenFile, FolderError> FilePlace::open() const {
    if (held_) {
        auto file = MemoryFile::make(shown());
        if (file && !file->write(*held_)) return unexpected(folder_error_of(errno, shown()));
        return file ? std::move(*file).opened() : unexpected(file.error());
    }
    if (folder_) {
        const auto folder = folder_->open();
        return folder ? folder->open_file(name_) : unexpected(folder.error());
    }
    const Descriptor path(::open(name_.c_str(), O_PATH | O_CLOEXEC));
    if (!path) return unexpected(folder_error_of(errno, name_));
    return open_ordinary(path, name_);
}

Result<std::string, FolderError> FilePlace::read(std::size_t bytes_max) const {
    if (held_) return held_->substr(0, bytes_max + 1);
    const auto opened = open();
    return opened ? opened->read(bytes_max) : unexpected(opened.error());
}

FilePlace FilePlace::beside(const fs::path& other) const {
    FilePlace place(*this);
    place.held_ = nullptr;
    // An absolute `other` replaces the whole path: allowed beside a typed file; below a folder it cannot be
    // opened.
    place.name_ = name_.parent_path() / other;
    return place;
}

Result<OpenFolder, FolderError> FilePlace::open_folder() const {
    if (!folder_) return OpenFolder::open(name_, FolderAccess::read);
    const auto folder = folder_->open();
    return folder ? folder->open_folder(name_) : folder;
}

Result<MadeFolder, FolderError> FilePlace::make_folder() const {
    if (!folder_) return make_open_folder(name_);
    const auto parent = parent_to_write();
    if (!parent) return unexpected(parent.error());
    const auto made = parent->make_folder(filename());
    if (!made && made.error().fault != FolderFault::is_there) return unexpected(made.error());
    auto folder = parent->open_folder(filename());
    if (!folder) return unexpected(folder.error());
    return MadeFolder{std::move(*folder), made.has_value()};
}

Result<OpenFolder, FolderError> FilePlace::parent_to_write() const {
    if (held_) return unexpected(folder_error_of(EROFS, shown()));
    const fs::path parent = name_.parent_path();
    if (!folder_) return OpenFolder::open(parent, FolderAccess::write);
    const auto opened = folder_->open();
    if (!opened) return unexpected(opened.error());
    auto folder = opened->to_write();
    if (!folder || parent.empty()) return folder;
    return folder->open_folder(parent);
}

Result<OpenFile, FolderError> FilePlace::create_new(unsigned mode) const {
    const auto folder = parent_to_write();
    if (!folder) return unexpected(folder.error());
    return folder->create_new(filename(), mode);
}

Result<OpenFile, FolderError> FilePlace::create_anew() const {
    if (!folder_ && kind() == EntryKind::other) {  // a typed device or pipe is written to directly
        Descriptor opened(::open(name_.c_str(), O_WRONLY | O_CLOEXEC));
        if (!opened) return unexpected(folder_error_of(errno, name_));
        return OpenFile(std::move(opened), name_);
    }
    const auto folder = parent_to_write();
    if (!folder) return unexpected(folder.error());
    const EntryKind there = folder->kind_of(filename());
    if (there == EntryKind::file || there == EntryKind::link) {
        if (const auto removed = folder->remove(filename()); !removed) return unexpected(removed.error());
    }
    return folder->create_new(filename());
}

}  // namespace octoskin
