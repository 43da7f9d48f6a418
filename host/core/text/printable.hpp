// Text for a terminal or a log. Part of it may be somebody else's: a key of a file, a file's name, what a
// robot's link is called. A terminal obeys what some characters order.
#pragma once

#include <string>
#include <string_view>

namespace octoskin {

/// One line. As it was but for what is no mark on the screen, which is shown by its number: the control
/// characters below 0x20, 0x7f and 0x80 to 0x9f as "\x1b" and the like, those that turn the direction of
/// writing and the two that end a line or paragraph as "\u202e", a byte that is no UTF-8 as "\xff". O(bytes).
[[nodiscard]] std::string printable(std::string_view text);

/// The same for text of our own making in several lines: line ends and tabs stay.
[[nodiscard]] std::string printable_lines(std::string_view text);

/// JSON that reads as the same: what printable() shows by its number is written as JSON's escape ("\\u202e").
/// Of JSON in UTF-8, as nlohmann writes it; line ends between values stay. O(bytes).
[[nodiscard]] std::string printable_json(std::string_view json);

}  // namespace octoskin
