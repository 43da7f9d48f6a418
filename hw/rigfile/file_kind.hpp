// The kind of file at a path. To open a named pipe may block for ever, and a device may have no end.
#pragma once

#include <filesystem>
#include <string_view>

namespace octoskin::rig {

/// "a directory", "a named pipe" and so on; empty for an ordinary file and for a missing one.
[[nodiscard]] inline std::string_view other_than_a_file(const std::filesystem::path& path) {
    std::error_code error;
    switch (std::filesystem::status(path, error).type()) {
        case std::filesystem::file_type::directory:
            return "a directory";
        case std::filesystem::file_type::fifo:
            return "a named pipe";
        case std::filesystem::file_type::character:
        case std::filesystem::file_type::block:
            return "a device";
        case std::filesystem::file_type::socket:
            return "a socket";
        case std::filesystem::file_type::unknown:  // no permission to read its kind
        case std::filesystem::file_type::none:
        case std::filesystem::file_type::not_found:
        case std::filesystem::file_type::regular:
        case std::filesystem::file_type::symlink:  // status() follows them
            break;
    }
    return {};
}

}  // namespace octoskin::rig
