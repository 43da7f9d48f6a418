// The text files of a data set: one thing a line, comments begin with '#'.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::tum {

/// "FILE:LINE: WHAT".
[[nodiscard]] DepthSourceError line_error(const std::filesystem::path& file, std::uint64_t line,
                                          const std::string& what);

/// Says what is wrong with a line; `number` from 1.
using TakeLine = std::function<Status<std::string>(std::uint64_t number, std::string_view line)>;

/// Gives every line that is neither blank nor a comment to `take`, until it refuses one. Errors name the file
/// and the line: not to be opened, a line over 4096 bytes, refused.
[[nodiscard]] Status<DepthSourceError> read_lines(const FilePlace& file, const TakeLine& take);

}  // namespace octoskin::tum
