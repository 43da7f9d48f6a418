// Why a file or folder named by the user, or one below it, is refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "host/errors/error.hpp"

namespace octoskin {

enum class FolderFault : std::uint8_t {
    absent,         ///< it does not exist
    link,           ///< a symbolic link below the named folder
    outside,        ///< a name that leads out of the folder ("..", an absolute one), or is not valid
    foreign_owner,  ///< it would be written to, and belongs to another user
    not_a_file,     ///< a folder, pipe, device or socket in place of a file
    not_a_folder,   ///< something else in place of a folder
    is_there,       ///< the name of a new file exists already
    not_permitted,  ///< it may not be read, written or searched
    system,         ///< any other error: see error_number
};

struct FolderError {
    FolderFault fault = FolderFault::system;
    std::filesystem::path path;  ///< the entry at fault: the link itself, the folder of another user
    int error_number = 0;        ///< errno
    std::string what = {};       ///< for not_a_file: "a named pipe"; for foreign_owner: the owner

    /// "rec/maps: is a symbolic link, and links are not followed below the named folder: ...".
    [[nodiscard]] std::string message() const;
    /// The message without the path.
    [[nodiscard]] std::string reason() const;
};

[[nodiscard]] ErrorCode code_of(FolderFault fault) noexcept;
/// `before` begins the sentence: "cannot be read: ".
[[nodiscard]] Error to_error(const FolderError& error, const std::string& before = {});

}  // namespace octoskin
