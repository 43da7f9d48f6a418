// Recognises log files of other programs by their beginning, and gives the command that converts them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octoskin::candump {

struct ForeignFormat {
    std::string_view name;  ///< the name that its users know
    /// Whether a file that begins with this text (its first kilobyte) has this format.
    bool (*is_begun_by)(std::string_view begin);
    std::string_view command;  ///< converts the file: `IN` is the file, `OUT` the result
    std::string_view awk;      ///< the beginning of an awk program; empty: `command` is not for awk
};

[[nodiscard]] std::span<const ForeignFormat> foreign_formats() noexcept;

/// The format of a file that begins with this text; null if it is none of the known ones.
[[nodiscard]] const ForeignFormat* foreign_format_of(std::string_view begin);

/// The complete shell command with these file names.
[[nodiscard]] std::string conversion(const ForeignFormat& format, std::string_view in, std::string_view out);

}  // namespace octoskin::candump
