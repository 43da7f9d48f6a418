// The error for a file that a user names and that cannot be opened.
#pragma once

#include <string>

#include "host/io/folder/folder_error.hpp"

namespace octoskin::rig {

/// `format`: of the expected file, "YAML". A link and a name outside the folder keep their own error.
[[nodiscard]] inline Error unopened_file(const FolderError& error, const std::string& format) {
    Error refused = to_error(error);
    if (error.fault == FolderFault::not_a_file) {
        refused.remedy = "give the path of an ordinary " + format + " file";
    } else if (error.fault != FolderFault::link && error.fault != FolderFault::outside) {
        refused.what = "cannot be opened";
        refused.remedy = "give the path of an existing, readable " + format + " file";
    }
    return refused;
}

}  // namespace octoskin::rig
