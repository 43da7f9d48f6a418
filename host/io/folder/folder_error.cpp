#include "host/io/folder/folder_error.hpp"

#include <fmt/format.h>

#include <system_error>

namespace octoskin {
namespace {

/// What is wrong with the entry, and the remedy.
Error described(const FolderError& error) {
    switch (error.fault) {
        case FolderFault::link:
            return {.what = "is a symbolic link, and links are not followed below the named folder",
                    .remedy = "put the file or folder itself there, or remove the link"};
        case FolderFault::outside:
            return {.what = "leads out of the folder", .remedy = "only files inside it are used"};
        case FolderFault::foreign_owner:
            return {.what = fmt::format("belongs to {}", error.what),
                    .remedy = "octoskin writes only to folders owned by you or root; give another folder"};
        case FolderFault::not_a_file:
            return {.what = fmt::format("is {}, not a regular file", error.what)};
        case FolderFault::not_a_folder:
            return {.what = "is not a folder"};
        case FolderFault::is_there:
            return {.what = "exists already", .remedy = "move it away"};
        case FolderFault::absent:
        case FolderFault::not_permitted:
        case FolderFault::system:
            break;
    }
    return {.what = std::generic_category().message(error.error_number)};
}

}  // namespace

ErrorCode code_of(FolderFault fault) noexcept {
    switch (fault) {
        case FolderFault::absent:
            return ErrorCode::not_found;
        case FolderFault::link:
            return ErrorCode::link;
        case FolderFault::outside:
            return ErrorCode::outside_folder;
        case FolderFault::foreign_owner:
            return ErrorCode::foreign_owner;
        case FolderFault::not_a_file:
        case FolderFault::not_a_folder:
            return ErrorCode::wrong_kind_of_file;
        case FolderFault::is_there:
            return ErrorCode::already_exists;
        case FolderFault::not_permitted:
            return ErrorCode::no_permission;
        case FolderFault::system:
            break;
    }
    return ErrorCode::system_error;
}

Error to_error(const FolderError& error, const std::string& before) {
    Error full = described(error);
    full.code = code_of(error.fault);
    full.what.insert(0, before);
    full.file = error.path;
    return full;
}

std::string FolderError::reason() const {
    return to_error(*this).reason();
}

std::string FolderError::message() const {
    return to_error(*this).message();
}

}  // namespace octoskin
