// All bytes of a file, up to a limit.
#pragma once

#include <cstdint>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// Refuses a file that is not regular, is larger than `bytes_max`, or becomes shorter meanwhile; bytes added
/// meanwhile are ignored. Throws std::bad_alloc.
[[nodiscard]] Result<std::string, Error> read_whole_file(const FilePlace& file, std::uint64_t bytes_max);

}  // namespace octoskin
