// The place of a file or folder: a path typed by the user, or a name below a folder that the user named.
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

/// A folder named by the user. It is opened once, when first needed, so that all files below it come from the
/// same folder even if its name changes meanwhile. Copies share it, also between threads.
class NamedFolder {
  public:
    NamedFolder(std::filesystem::path typed);
    explicit NamedFolder(OpenFolder opened);
    /// A folder inside a named one.
    explicit NamedFolder(FilePlace place);

    /// The path as the user named it: for messages and provenance, never for opening.
    [[nodiscard]] const std::filesystem::path& shown() const noexcept;
    /// Errors: as OpenFolder::open; the next call then tries again.
    [[nodiscard]] Result<OpenFolder, FolderError> open() const;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

/// Functions that read or write one file take this type in place of a path, so that the rules of OpenFolder
/// apply to files below a folder. A path typed by the user converts implicitly; links in it are followed.
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
    /// `place` with this content, which this process holds, whatever becomes of the file. It is not for
    /// writing.
    [[nodiscard]] static FilePlace held(std::string content, FilePlace place);

    [[nodiscard]] bool empty() const noexcept { return name_.empty(); }
    /// The path as the user knows it: for messages and provenance, never for opening.
    [[nodiscard]] std::filesystem::path shown() const { return folder_ ? folder_->shown() / name_ : name_; }
    [[nodiscard]] std::string filename() const { return name_.filename().string(); }
    /// The named folder; null for a typed path.
    [[nodiscard]] const NamedFolder* folder() const noexcept { return folder_ ? &*folder_ : nullptr; }
    /// The name below that folder, or the typed path.
    [[nodiscard]] const std::filesystem::path& name() const noexcept { return name_; }

    /// For a typed path: the kind of the target of its links.
    [[nodiscard]] EntryKind kind() const;
    [[nodiscard]] bool is_file() const { return kind() == EntryKind::file; }
    /// True if anything exists there, also a link below a folder.
    [[nodiscard]] bool is_there() const { return kind() != EntryKind::absent; }
    /// Opens a regular file for reading. Errors: as OpenFolder::open_file.
    [[nodiscard]] Result<OpenFile, FolderError> open() const;
    /// The content, at most `bytes_max` + 1 bytes, as OpenFile::read. Errors: those of open() and read().
    [[nodiscard]] Result<std::string, FolderError> read(std::size_t bytes_max) const;
    /// The place of `other`, a file name in the text of this file, relative to this file. Below a named
    /// folder it stays inside, or cannot be opened (outside).
    [[nodiscard]] FilePlace beside(const std::filesystem::path& other) const;

    /// Opens a folder for reading. Errors: as OpenFolder::open.
    [[nodiscard]] Result<OpenFolder, FolderError> open_folder() const;
    /// Opens a folder for writing and creates it if it does not exist, for a typed path with its parents.
    /// Errors: as OpenFolder::open, and link.
    [[nodiscard]] Result<MadeFolder, FolderError> make_folder() const;

    /// The folder of this place, for writing. Errors: as OpenFolder::open.
    [[nodiscard]] Result<OpenFolder, FolderError> parent_to_write() const;

    /// A new file for writing. It replaces a file or link of that name, which is removed: a link is not
    /// followed, and other hard links stay unchanged. Errors: is_there (a folder or a device; a typed device
    /// is written to); as parent_to_write.
    [[nodiscard]] Result<OpenFile, FolderError> create_anew() const;
    /// A new file; an error if the name exists.
    [[nodiscard]] Result<OpenFile, FolderError> create_new(unsigned mode = 0666) const;

    bool operator==(const FilePlace& other) const { return shown() == other.shown(); }

  private:
    std::optional<NamedFolder> folder_;
    std::filesystem::path name_;
    std::shared_ptr<const std::string> held_;
};

}  // namespace octoskin
