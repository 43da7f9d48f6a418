#include "host/io/folder/folder_error.hpp"

#include <fmt/format.h>

#include <system_error>

namespace octoskin {

std::string FolderError::reason() const {
    switch (fault) {
        case FolderFault::link:
            return "is a symbolic link; links are not followed below the named folder: put the file or "
                   "folder itself there, or remove the link";
        case FolderFault::outside:
            return "leads out of the folder; only files inside it are used";
        case FolderFault::foreign_owner:
            return fmt::format(
                "belongs to {}: octoskin writes only to folders owned by you or root; give another folder",
                what);
        case FolderFault::not_a_file:
            return fmt::format("is {}, not a regular file", what);
        case FolderFault::not_a_folder:
            return "is not a folder";
        case FolderFault::is_there:
            return "exists already; move it away";
        case FolderFault::absent:
        case FolderFault::not_permitted:
        case FolderFault::system:
            break;
    }
    return std::generic_category().message(error_number);
}

std::string FolderError::message() const {
    return path.string() + ": " + reason();
}

}  // namespace octoskin
