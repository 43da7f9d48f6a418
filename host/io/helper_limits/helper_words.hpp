// What a helper says on its standard error, which a foreign file may have it say.
#pragma once

#include <string>
#include <string_view>

namespace octoskin {

/// Its lines as a terminal may see them: control characters are shown by their numbers, and each line begins
/// with "HELPER: ", so that none is taken for one of ours. Empty lines are left out.
[[nodiscard]] std::string helper_lines(std::string_view helper, std::string_view words);

/// Puts on our standard error what a pipe without waiting holds, up to 64 KiB.
void show_helper_words(std::string_view helper, int descriptor);

}  // namespace octoskin
