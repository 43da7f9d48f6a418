// The text files of a data set: one entry a line, comments begin with '#'.
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

/// Lines that are invalid: their number, and the first one with its reason.
struct BadLines {
    std::uint64_t count = 0;
    std::optional<Error> first;

    void add(Error error) {
        if (count++ == 0) first = std::move(error);
    }
};

/// The error at a line of the file.
[[nodiscard]] Error line_error(const std::filesystem::path& file, std::uint64_t line, Error error);

/// Returns the fault of a line; `number` counts from 1.
using TakeLine = std::function<Status<std::string>(std::uint64_t number, std::string_view line)>;

/// Passes every line that is neither blank nor a comment to `take`. Lines that it refuses, and lines over
/// 4096 bytes, are counted. Errors name the file: it cannot be opened, or reading fails.
[[nodiscard]] Result<BadLines, Error> read_lines(const FilePlace& file, const TakeLine& take);

/// The whole file, if it has at most 4096 bytes. Errors: as read_lines.
[[nodiscard]] Result<std::string, Error> read_small_file(const FilePlace& file);

}  // namespace octoskin::tum
