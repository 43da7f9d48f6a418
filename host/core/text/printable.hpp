// Makes text safe for a terminal or a log. Parts of a text can come from foreign files: keys, file names,
// link names. A terminal executes control characters in them.
#pragma once

#include <string>
#include <string_view>

namespace octoskin {

/// One line. Characters without a visible form are replaced by their number: control characters below 0x20,
/// 0x7f and 0x80 to 0x9f as "\x1b"; characters that change the writing direction and the two that end a line
/// or paragraph as "\u202e"; bytes that are not valid UTF-8 as "\xff". All else is unchanged. O(bytes).
[[nodiscard]] std::string printable(std::string_view text);

/// The same for the program's own text of several lines: line ends and tabs remain.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// Equivalent JSON: characters that printable() replaces by their number become JSON escapes ("\\u202e").
/// Input: JSON in UTF-8 as nlohmann writes it. Line ends between values remain. O(bytes).
[[nodiscard]] std::string printable_json(std::string_view json);

}  // namespace octoskin
