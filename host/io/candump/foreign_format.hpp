// Log files of other programs, recognised by how they begin, and what converts them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octoskin::candump {

struct ForeignFormat {
    std::string_view name;  ///< what its users call it
    /// Whether a file that begins so (its first kilobyte, as text) is one.
    bool (*is_begun_by)(std::string_view begin);
    std::string_view command;  ///< that makes a log of it: `IN` is the file, `OUT` what it writes
    std::string_view awk;      ///< how the program for awk begins; empty: the command is another
};

[[nodiscard]] std::span<const ForeignFormat> foreign_formats() noexcept;

/// The format of a file that begins so; null if it is none of them.
[[nodiscard]] const ForeignFormat* foreign_format_of(std::string_view begin);

/// The whole command, for a shell, with these names in it.
[[nodiscard]] std::string conversion(const ForeignFormat& format, std::string_view in, std::string_view out);

}  // namespace octoskin::candump
