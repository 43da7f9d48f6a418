#include "host/apps/recording/permission.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace octoskin {

std::optional<AppError> refused_to_read(const FilePlace& file) {
    int error = 0;
    if (file.folder() != nullptr) {
        const auto opened = file.open();
        if (!opened && opened.error().fault == FolderFault::not_permitted)
            error = opened.error().error_number;
    } else if (::faccessat(AT_FDCWD, file.name().c_str(), R_OK, AT_EACCESS) != 0) {
        error = errno;
    }
    if (error != EACCES && error != EPERM) return std::nullopt;
    return AppError{
        ExitCode::no_permission,
        {.code = ErrorCode::no_permission,
         .what = "cannot be read (" + std::generic_category().message(error) + ")",
         .remedy =
             "its owner can permit it (chmod, chgrp; also its folders), or run as a user who may read it",
         .file = file.shown()}};
}

AppError reading_error(const FilePlace& file, AppError otherwise) {
    if (auto refused = refused_to_read(file)) return std::move(*refused);
    return otherwise;
}

}  // namespace octoskin
