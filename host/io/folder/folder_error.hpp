// Why a file or folder that a user named, or one below it, is not used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace octoskin {

enum class FolderFault : std::uint8_t {
    absent,         ///< nothing is there
    link,           ///< a symbolic link below the folder that was named
    outside,        ///< a name that leads out of the folder ("..", an absolute one), or is none
    foreign_owner,  ///< to be written to, and belongs to somebody else
    not_a_file,     ///< a folder, pipe, device or socket in a file's place
    not_a_folder,   ///< in a folder's place
    is_there,       ///< in the place of something new
    not_permitted,  ///< may not be read, written or looked for
    system,         ///< anything else: error_number says what
};

struct FolderError {
    FolderFault fault = FolderFault::system;
    std::filesystem::path path;  ///< what is at fault: the link itself, the folder of somebody else
    int error_number = 0;        ///< errno
    std::string what = {};       ///< of not_a_file: "a named pipe"; of foreign_owner: whose it is

    /// "rec/maps: is a symbolic link; octoskin follows none below the folder that you name: ...".
    [[nodiscard]] std::string message() const;
    /// The message without the path.
    [[nodiscard]] std::string reason() const;
};

}  // namespace octoskin
