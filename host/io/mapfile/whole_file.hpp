// All bytes of a file, up to a limit.
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

/// Refuses a file that is not regular, is larger than `bytes_max`, or becomes shorter meanwhile; bytes added
/// meanwhile are ignored. Throws std::bad_alloc.
[[nodiscard]] Result<std::string, WholeFileError> read_whole_file(const FilePlace& file,
                                                                  std::uint64_t bytes_max);

}  // namespace octoskin
