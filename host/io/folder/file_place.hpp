// Where a file or folder is: a path that a user typed, or a name below a folder that a user named.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/io/folder/folder_error.hpp"
#include "host/io/folder/open_file.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

class FilePlace;

/// A folder that a user named, opened when it is first needed, and once: what is found below it is of one
/// folder, whatever becomes of its name. Copies share it; threads may.
class NamedFolder {
  public:
    NamedFolder(std::filesystem::path typed);
    explicit NamedFolder(OpenFolder opened);
    /// A folder in a named one.
    explicit NamedFolder(FilePlace place);

    /// As the user named it: for messages and for provenance, never to be opened.
    [[nodiscard]] const std::filesystem::path& shown() const noexcept;
    /// Errors: as OpenFolder::open; the next call tries again then.
    [[nodiscard]] Result<OpenFolder, FolderError> open() const;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// What reads or writes one file takes this in place of a path: the rules of OpenFolder then hold wherever
/// the file is. A path that a user typed converts to it by itself; links in it are followed.
class FilePlace {
  public:
    FilePlace() = default;  ///< no file
    FilePlace(std::filesystem::path typed) : name_(std::move(typed)) {}
    FilePlace(const char* typed) : name_(typed) {}
    FilePlace(std::string typed) : name_(std::move(typed)) {}
    FilePlace(NamedFolder folder, std::filesystem::path name)
        : folder_(std::move(folder)), name_(std::move(name)) {}
    FilePlace(OpenFolder folder, std::filesystem::path name)
        : FilePlace(NamedFolder(std::move(folder)), std::move(name)) {}

    [[nodiscard]] bool empty() const noexcept { return name_.empty(); }
    /// As the user knows it: for messages and for provenance, never to be opened.
    [[nodiscard]] std::filesystem::path shown() const { return folder_ ? folder_->shown() / name_ : name_; }
    [[nodiscard]] std::string filename() const { return name_.filename().string(); }
    /// Where it is below a named folder; null: a path that was typed.
    [[nodiscard]] const NamedFolder* folder() const noexcept { return folder_ ? &*folder_ : nullptr; }
    /// Below that folder; or as it was typed.
    [[nodiscard]] const std::filesystem::path& name() const noexcept { return name_; }

    /// Of a typed path, what its links lead to.
    [[nodiscard]] EntryKind kind() const;
    [[nodiscard]] bool is_file() const { return kind() == EntryKind::file; }
    /// Anything at all, a link below a folder included.
    [[nodiscard]] bool is_there() const { return kind() != EntryKind::absent; }
    /// For reading, if it is an ordinary file. Errors: as OpenFolder::open_file.
    [[nodiscard]] Result<OpenFile, FolderError> open() const;
    /// What `other`, a file's name, leads to when this file speaks of it: relative to this file. Below a
    /// named folder it stays there, or cannot be opened (outside).
    [[nodiscard]] FilePlace beside(const std::filesystem::path& other) const;

    /// If it is a folder: for reading. Errors: as OpenFolder::open.
    [[nodiscard]] Result<OpenFolder, FolderError> open_folder() const;
    /// A folder to write to, made if nothing is there: of a typed path with its parents. Errors: as
    /// OpenFolder::open, and link.
    [[nodiscard]] Result<MadeFolder, FolderError> make_folder() const;

    /// Its folder, to write to. Errors: as OpenFolder::open.
    [[nodiscard]] Result<OpenFolder, FolderError> parent_to_write() const;

    /// A new file to write to, in place of the file or link that is there, which is removed: a link is not
    /// followed, and of a file with several names the others stay as they are. Errors: is_there (a folder, a
    /// device; a typed one takes what is written); as parent_to_write.
    [[nodiscard]] Result<OpenFile, FolderError> create_anew() const;
    /// A new file; refuses whatever is there.
    [[nodiscard]] Result<OpenFile, FolderError> create_new(unsigned mode = 0666) const;

    bool operator==(const FilePlace& other) const { return shown() == other.shown(); }

  private:
    std::optional<NamedFolder> folder_;
    std::filesystem::path name_;
};

}  // namespace octoskin
