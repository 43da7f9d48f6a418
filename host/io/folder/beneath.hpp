// Opens what is below an open folder: no name, and no link on the way, leads out of it.
#pragma once

#include <linux/openat2.h>

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/descriptor.hpp"
#include "host/io/folder/folder_error.hpp"

namespace octoskin {

/// The system call openat2 with its own return values and errno: a kernel before 5.6, or a container's
/// filter, has none (ENOSYS, EPERM), and each component is then opened by itself.
using OpenAt2 = int (*)(int folder, const char* name, const open_how& how);
[[nodiscard]] int system_openat2(int folder, const char* name, const open_how& how);

/// `name` without "." and "..". Error (outside): empty, absolute, with a NUL, or leading out.
[[nodiscard]] Result<std::string, FolderError> name_beneath(const std::filesystem::path& shown,
                                                            const std::filesystem::path& name);

struct FolderBase {
    int descriptor = -1;
    std::filesystem::path shown;  ///< for messages
    OpenAt2 openat2 = system_openat2;
};

/// Opens `name`, as name_beneath() gives it, with openat's `flags`; links are refused in each component, the
/// last included. The error names the component that is at fault.
[[nodiscard]] Result<Descriptor, FolderError> open_beneath(const FolderBase& base, const std::string& name,
                                                           int flags, unsigned mode = 0);

/// What errno says about `path`.
[[nodiscard]] FolderError folder_error_of(int error_number, const std::filesystem::path& path);

}  // namespace octoskin
