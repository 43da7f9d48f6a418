// All bytes of a file, within a limit.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

struct WholeFileError {
    std::string message;  ///< "maps/fused.ot: not a regular file"
    bool is_too_large = false;
};

/// Refuses what is no regular file, what is larger than `bytes_max`, and what becomes shorter meanwhile; what
/// is added meanwhile is left out. Throws std::bad_alloc.
[[nodiscard]] Result<std::string, WholeFileError> read_whole_file(const FilePlace& file,
                                                                  std::uint64_t bytes_max);

}  // namespace octoskin
