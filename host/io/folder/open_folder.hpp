// A folder that a user named, opened once: all that is below it is found beneath that descriptor.
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

/// Links in the path that was typed are followed; below it none is. Names are relative to the folder and may
/// go through folders in it ("maps/fused.ot"). A folder that is written to belongs to the caller or to root;
/// root writes into any. Copies share the descriptor. Verbs that change something assert access to write.
class OpenFolder {
  public:
    /// Errors: absent, not_a_folder, not_permitted, foreign_owner (to write), the system's.
    [[nodiscard]] static Result<OpenFolder, FolderError> open(const std::filesystem::path& typed,
                                                              FolderAccess access,
                                                              OpenAt2 openat2 = system_openat2);

    /// The same folder, to write to. Errors: foreign_owner, the system's.
    [[nodiscard]] Result<OpenFolder, FolderError> to_write() const;

    /// As the user named it: for messages, never to be opened.
    [[nodiscard]] const std::filesystem::path& shown() const noexcept { return base_->shown; }
    [[nodiscard]] std::filesystem::path shown(const std::filesystem::path& name) const {
        return base_->shown / name;
    }
    [[nodiscard]] int descriptor() const noexcept { return base_->descriptor; }
    [[nodiscard]] FolderAccess access() const noexcept { return access_; }
    /// For what wants a path: leads to this very folder as long as this is open, in this process.
    [[nodiscard]] std::filesystem::path path_for_libraries() const;
    /// Whether the path that was typed still leads here: the folder may have been removed or replaced.
    [[nodiscard]] bool is_still_there() const;

    /// What is at `name`; a link anywhere in it is `link`. A name that leads out, or may not be looked at, is
    /// `other`.
    [[nodiscard]] EntryKind kind_of(const std::filesystem::path& name) const;
    /// Names of what is in the folder, in order, but for "." and "..".
    [[nodiscard]] Result<std::vector<std::string>, FolderError> names() const;
    /// For reading. Errors: not_a_file, link, outside, absent, not_permitted.
    [[nodiscard]] Result<OpenFile, FolderError> open_file(const std::filesystem::path& name) const;
    /// With the same access, and the same rule about its owner.
    [[nodiscard]] Result<OpenFolder, FolderError> open_folder(const std::filesystem::path& name) const;

    /// A new, empty file to write to. Errors: is_there, whatever it is that is there.
    [[nodiscard]] Result<OpenFile, FolderError> create_new(const std::filesystem::path& name,
                                                           unsigned mode = 0666) const;
    /// A new folder. Error: is_there.
    [[nodiscard]] Status<FolderError> make_folder(const std::filesystem::path& name) const;
    /// To another name in this folder, in place of a file that is there; a link is moved, not followed.
    [[nodiscard]] Status<FolderError> move(const std::filesystem::path& from,
                                           const std::filesystem::path& to) const;
    /// A second name for the same file. Error: is_there; the system's, where there are no hard links.
    [[nodiscard]] Status<FolderError> link(const std::filesystem::path& from,
                                           const std::filesystem::path& to) const;
    /// A file, or the link itself; done if nothing is there.
    [[nodiscard]] Status<FolderError> remove(const std::filesystem::path& name) const;
    /// The same with all that is in it; a link in it is removed, not followed.
    [[nodiscard]] Status<FolderError> remove_all(const std::filesystem::path& name) const;
    /// An empty folder. Error: not empty, and the like.
    [[nodiscard]] Status<FolderError> remove_empty(const std::filesystem::path& name) const;
    /// This folder, or the file of this name, to the disk.
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
    /// An open folder, and a name in it without a slash.
    struct Spot {
        Descriptor folder;
        std::string leaf;
        std::filesystem::path shown;
    };
    [[nodiscard]] Result<Spot, FolderError> spot(const std::filesystem::path& name) const;

    std::shared_ptr<const Base> base_;
    FolderAccess access_;
};

/// A folder that is to be written to, and whether it was made for that.
struct MadeFolder {
    OpenFolder folder;
    bool is_new = false;
};

enum class Parents : std::uint8_t { must_be_there, are_made };

/// Opens a folder to write to, making it if nothing is there. Errors: as OpenFolder::open.
[[nodiscard]] Result<MadeFolder, FolderError> make_open_folder(const std::filesystem::path& typed,
                                                               Parents parents = Parents::are_made);

}  // namespace octoskin
