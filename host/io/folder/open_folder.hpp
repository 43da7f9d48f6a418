// A folder named by the user, opened once: everything below it is reached through that descriptor.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/beneath.hpp"
#include "host/io/folder/folder_error.hpp"
#include "host/io/folder/open_file.hpp"

namespace octoskin {

enum class FolderAccess : std::uint8_t { read, write };
enum class EntryKind : std::uint8_t { absent, file, folder, link, other };

/// Links in the typed path are followed; below the folder none is. Names are relative to the folder and may
/// contain subfolders ("maps/fused.ot"). A folder that is written to must belong to the caller or to root;
/// root may write into any. Copies share the descriptor. Functions that change something assert write access.
class OpenFolder {
  public:
    /// Errors: absent, not_a_folder, not_permitted, foreign_owner (for writing), those of the system.
    [[nodiscard]] static Result<OpenFolder, FolderError> open(const std::filesystem::path& typed,
                                                              FolderAccess access,
                                                              OpenAt2 openat2 = system_openat2);

    /// The same folder for writing. Errors: foreign_owner, those of the system.
    [[nodiscard]] Result<OpenFolder, FolderError> to_write() const;

    /// The path as the user named it: for messages, never for opening.
    [[nodiscard]] const std::filesystem::path& shown() const noexcept { return base_->shown; }
    [[nodiscard]] std::filesystem::path shown(const std::filesystem::path& name) const {
        return base_->shown / name;
    }
    [[nodiscard]] int descriptor() const noexcept { return base_->descriptor; }
    [[nodiscard]] FolderAccess access() const noexcept { return access_; }
    /// A path for libraries: it leads to this folder while this object is open, in this process.
    [[nodiscard]] std::filesystem::path path_for_libraries() const;
    /// Whether the typed path still leads to this folder: it may have been removed or replaced.
    [[nodiscard]] bool is_still_there() const;

    /// The kind of the entry at `name`; `link` if any component is a link. A name that leads out of the
    /// folder, or may not be examined, is `other`.
    [[nodiscard]] EntryKind kind_of(const std::filesystem::path& name) const;
    /// The sorted names in the folder, without "." and "..".
    [[nodiscard]] Result<std::vector<std::string>, FolderError> names() const;
    /// For reading. Errors: not_a_file, link, outside, absent, not_permitted.
    [[nodiscard]] Result<OpenFile, FolderError> open_file(const std::filesystem::path& name) const;
    /// With the same access, and the same rule about the owner.
    [[nodiscard]] Result<OpenFolder, FolderError> open_folder(const std::filesystem::path& name) const;

    /// A new, empty file for writing. Error: is_there, if the name exists in any form.
    [[nodiscard]] Result<OpenFile, FolderError> create_new(const std::filesystem::path& name,
                                                           unsigned mode = 0666) const;
    /// A new folder. Error: is_there.
    [[nodiscard]] Status<FolderError> make_folder(const std::filesystem::path& name) const;
    /// Renames within this folder and replaces an existing file; a link is moved, not followed.
    [[nodiscard]] Status<FolderError> move(const std::filesystem::path& from,
                                           const std::filesystem::path& to) const;
    /// Makes a hard link. Errors: is_there; those of the system, also where hard links are not supported.
    [[nodiscard]] Status<FolderError> link(const std::filesystem::path& from,
                                           const std::filesystem::path& to) const;
    /// Removes a file, or a link itself; no error if it does not exist.
    [[nodiscard]] Status<FolderError> remove(const std::filesystem::path& name) const;
    /// Removes recursively; a link is removed, not followed.
    [[nodiscard]] Status<FolderError> remove_all(const std::filesystem::path& name) const;
    /// Removes an empty folder. Error: it is not empty, or another one of the system.
    [[nodiscard]] Status<FolderError> remove_empty(const std::filesystem::path& name) const;
    /// Flushes this folder, or the file of this name, to the disk.
    [[nodiscard]] Status<FolderError> flush() const;
    [[nodiscard]] Status<FolderError> flush(const std::filesystem::path& name) const;

  private:
    struct Base : FolderBase {
        Descriptor owner;
    };
    OpenFolder(Descriptor descriptor, std::filesystem::path shown, FolderAccess access, OpenAt2 openat2);
    [[nodiscard]] static Result<OpenFolder, FolderError> checked(Descriptor descriptor,
                                                                 std::filesystem::path shown,
                                                                 FolderAccess access, OpenAt2 openat2);
    /// An open folder and a name in it without a slash.
    struct Spot {
        Descriptor folder;
        std::string leaf;
        std::filesystem::path shown;
    };
    [[nodiscard]] Result<Spot, FolderError> spot(const std::filesystem::path& name) const;

    std::shared_ptr<const Base> base_;
    FolderAccess access_;
};

/// A folder for writing, and whether it was created for that.
struct MadeFolder {
    OpenFolder folder;
    bool is_new = false;
};

enum class Parents : std::uint8_t { must_be_there, are_made };

/// Opens a folder for writing and creates it if it does not exist. Errors: as OpenFolder::open.
[[nodiscard]] Result<MadeFolder, FolderError> make_open_folder(const std::filesystem::path& typed,
                                                               Parents parents = Parents::are_made);

}  // namespace octoskin
