// The outline of an .oni file, read without OpenNI2: what its recorder has written so far.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octoskin::openni2 {

struct OniOutline {
    bool has_begun = false;    ///< the record that says that frames follow is there
    std::uint32_t frames = 0;  ///< whole ones, of all streams
    std::optional<std::uintmax_t>
        length;  ///< where the last record ends; empty in a file that was not finished
};

/// O(records) small reads. Stops where the file or its sense does; a file that is not there has nothing in
/// it.
[[nodiscard]] OniOutline outline_of(const std::filesystem::path& oni);

}  // namespace octoskin::openni2
