// What the view counts: every connection and message that it does not use has one name.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "host/bridge/view/admission.hpp"

namespace octoskin::view {

struct ViewCounts {
    std::uint64_t clients = 0;                                  ///< accepted so far
    std::array<std::uint64_t, kRefusalNames.size()> refused{};  ///< by Refusal
    std::uint64_t unsupported = 0;                              ///< requests that the server does not have
    std::uint64_t refused_calls = 0;                            ///< of services
    std::uint64_t dropped = 0;  ///< messages that a slow client did not get, of all clients

    [[nodiscard]] std::uint64_t of(Refusal why) const { return refused[static_cast<std::size_t>(why)]; }
    /// "origin 3, silent 12"; empty if there is none.
    [[nodiscard]] std::string refused_text() const {
        std::string text;
        for (std::size_t i = 0; i < refused.size(); ++i)
            if (refused[i] > 0)
                text += (text.empty() ? "" : ", ") + std::string(kRefusalNames[i]) + ' ' +
                        std::to_string(refused[i]);
        return text;
    }
};

}  // namespace octoskin::view
