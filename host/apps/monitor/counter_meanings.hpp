// What a counter of the account means, in a sentence for whoever stands before the screen.
#pragma once

#include <string_view>

namespace octoskin {

/// `unit` and `name` as AccountTable has them; empty for one that is not known.
[[nodiscard]] std::string_view meaning_of(std::string_view unit, std::string_view name) noexcept;

}  // namespace octoskin
