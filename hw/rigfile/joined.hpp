// A list of words or numbers for a message: "15, 20, 33". (fmt::join trips GCC 12's overflow warning at -O3.)
#pragma once

#include <concepts>
#include <string>

namespace octoskin::rig {

[[nodiscard]] std::string joined(const auto& items) {
    std::string text;
    for (const auto& item : items) {
        if (!text.empty()) text += ", ";
        if constexpr (requires { std::to_string(item); }) {
            text += std::to_string(item);
        } else {
            text += item;
        }
    }
    return text;
}

}  // namespace octoskin::rig
