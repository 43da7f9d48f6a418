// The outline of an .oni file, read without OpenNI2: what its recorder has written so far.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octoskin::openni2 {

struct OniOutline {
    bool has_begun = false;                ///< the record that announces frames exists
    std::uint32_t frames = 0;              ///< complete ones, of all streams
    std::optional<std::uintmax_t> length;  ///< end of the last record; empty for a file that was not finished
};

/// O(records) small reads. Stops at the end of the file or at the first invalid record; a missing file counts
/// as empty.
[[nodiscard]] OniOutline outline_of(const std::filesystem::path& oni);

}  // namespace octoskin::openni2
