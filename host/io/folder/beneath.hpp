// Opens files below an open folder: neither a name nor a link on the way can lead out of it.
#pragma once

#include <linux/openat2.h>

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/descriptor.hpp"
#include "host/io/folder/folder_error.hpp"

namespace octoskin {

/// The system call openat2 with its own return values and errno. It is missing (ENOSYS, EPERM) in kernels
/// before 5.6 and under some containers' filters; then each component is opened separately.
using OpenAt2 = int (*)(int folder, const char* name, const open_how& how);
[[nodiscard]] int system_openat2(int folder, const char* name, const open_how& how);

/// `name` without "." and "..". Error (outside): it is empty or absolute, contains a NUL, or leads out of the
/// folder.
[[nodiscard]] Result<std::string, FolderError> name_beneath(const std::filesystem::path& shown,
                                                            const std::filesystem::path& name);

struct FolderBase {
    int descriptor = -1;
    std::filesystem::path shown;  ///< for messages
    OpenAt2 openat2 = system_openat2;
};

/// Opens `name`, a result of name_beneath(), with openat's `flags`. A link in any component is refused, also
/// in the last. The error names the component at fault.
[[nodiscard]] Result<Descriptor, FolderError> open_beneath(const FolderBase& base, const std::string& name,
                                                           int flags, unsigned mode = 0);

/// The error for this errno at `path`.
[[nodiscard]] FolderError folder_error_of(int error_number, const std::filesystem::path& path);

}  // namespace octoskin
