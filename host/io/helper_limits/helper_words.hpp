// Handles a helper's standard error, whose text an untrusted file may control.
#pragma once

#include <string>
#include <string_view>

namespace octoskin {

/// The lines in a form safe for a terminal: control characters are shown as numbers, and each line begins
/// with "HELPER: ", so that it cannot be mistaken for a message of this program. Empty lines are removed.
[[nodiscard]] std::string helper_lines(std::string_view helper, std::string_view words);

/// Copies the content of a non-blocking pipe, up to 64 KiB, to this program's standard error.
void show_helper_words(std::string_view helper, int descriptor);

}  // namespace octoskin
