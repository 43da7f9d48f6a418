// A name and its meaning, as a sentence for the person at the screen.
#pragma once

#include <span>
#include <string_view>

namespace octoskin {

struct Meaning {
    std::string_view group;  ///< what it belongs to
    std::string_view name;
    std::string_view text;
};

/// The text of `name` in `group`; empty if there is none. O(meanings).
[[nodiscard]] constexpr std::string_view find_meaning(std::span<const Meaning> meanings,
                                                      std::string_view group,
                                                      std::string_view name) noexcept {
    for (const Meaning& meaning : meanings)
        if (meaning.group == group && meaning.name == name) return meaning.text;
    return {};
}

}  // namespace octoskin
