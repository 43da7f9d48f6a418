// What a path leads to: whoever opens a named pipe may wait for ever, and a device may have no end.
#pragma once

#include <filesystem>
#include <string_view>

namespace octoskin::rig {

/// "a directory", "a named pipe" and so on; empty for an ordinary file, and for nothing at all.
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
        case std::filesystem::file_type::unknown:  // nobody may look at it
        case std::filesystem::file_type::none:
        case std::filesystem::file_type::not_found:
        case std::filesystem::file_type::regular:
        case std::filesystem::file_type::symlink:  // status() follows them
            break;
    }
    return {};
}

}  // namespace octoskin::rig
