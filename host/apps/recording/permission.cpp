#include "host/apps/recording/permission.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace octoskin {

std::optional<AppError> refused_to_read(const std::filesystem::path& file) {
    if (::faccessat(AT_FDCWD, file.c_str(), R_OK, AT_EACCESS) == 0) return std::nullopt;
    const int error = errno;
    if (error != EACCES && error != EPERM) return std::nullopt;
    return AppError{ExitCode::no_permission,
                    file.string() + ": cannot be read (" + std::generic_category().message(error) +
                        "): its owner can let you (chmod, chgrp; its folders, too), or ask as one who may"};
}

AppError reading_error(const std::filesystem::path& file, AppError otherwise) {
    if (auto refused = refused_to_read(file)) return std::move(*refused);
    return otherwise;
}

}  // namespace octoskin
