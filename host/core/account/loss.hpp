// Whether so much of an input was rejected that a person should know why.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "host/core/account/account.hpp"

namespace octoskin {

/// Most of what came in was rejected.
struct Loss {
    std::string unit;            ///< "readings"
    std::uint64_t rejected = 0;  ///< of `of`
    std::uint64_t of = 0;
    /// Over half of what could have been used was lost for reasons that a user can mend. False: the scene
    /// explains it, or other devices of the bus.
    bool is_mendable = false;
    std::string reason;       ///< the most frequent one of those reasons: a counter's name
    std::uint64_t count = 0;  ///< how many it rejected
    std::string first;        ///< where the first of them was; empty: not known
};

/// By the causes of counter_meanings(). What could have been used: what was, and what was lost for a mendable
/// cause. Empty if no cause rejected over half, or what is pending may still change that. O(reasons).
[[nodiscard]] std::optional<Loss> loss_of(const AccountTable& table);

/// The most frequent reason, whatever its cause and however few it rejected; empty if nothing was rejected.
[[nodiscard]] std::optional<Loss> most_frequent(const AccountTable& table);

/// " Give the rig with the camera.": what mends it; empty if nothing does.
[[nodiscard]] std::string remedy_sentence(std::string_view unit, std::string_view name);

/// "readings: 2315 of 2643 are lost, most as clock_in_doubt (2310, the first at 12.3 s): MEANING. REMEDY."
[[nodiscard]] std::string describe(const Loss& loss);

}  // namespace octoskin
