// The text files of a data set: one thing a line, comments begin with '#'.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/core/depth/depth_source.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::tum {

/// Lines that mean nothing, or not what they should: how many, and the first with its reason.
struct BadLines {
    std::uint64_t count = 0;
    std::optional<DepthSourceError> first;

    void add(DepthSourceError error) {
        if (count++ == 0) first = std::move(error);
    }
};

/// "FILE:LINE: WHAT".
[[nodiscard]] DepthSourceError line_error(const std::filesystem::path& file, std::uint64_t line,
                                          const std::string& what);

/// Says what is wrong with a line; `number` from 1.
using TakeLine = std::function<Status<std::string>(std::uint64_t number, std::string_view line)>;

/// Gives every line that is neither blank nor a comment to `take`. Those that it refuses, and those over 4096
/// bytes, are counted. Errors name the file: not to be opened, not to be read on.
[[nodiscard]] Result<BadLines, DepthSourceError> read_lines(const FilePlace& file, const TakeLine& take);

/// The whole file, if it has at most 4096 bytes. Errors as those of read_lines.
[[nodiscard]] Result<std::string, DepthSourceError> read_small_file(const FilePlace& file);

}  // namespace octoskin::tum
