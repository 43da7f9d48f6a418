// What a counter of the account means, what explains it, and what a user does about it: the one table.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace octoskin {

/// What explains that an input was rejected, and with it whether a user can have it used.
enum class Cause : std::uint8_t {
    scene,    ///< what was there to be seen: out of range, no target, the robot itself
    outside,  ///< it lies outside the marks, before the first clock exchange, or the rig has no use for it
    other_device,  ///< it is not octoskin's: other traffic of the same bus, or a message to others than the
                   ///< host
    mendable,      ///< a user can mend it: the rig, the recording, the wiring, a second sender
};

struct CounterMeaning {
    std::string_view unit;
    std::string_view name;
    std::string_view text;
    Cause cause = Cause::mendable;
    std::string_view remedy;  ///< an imperative without a full stop; empty: there is nothing to do
};

/// Of every unit; units and names are as AccountTable has them. docs/account.md has the same table.
[[nodiscard]] std::span<const CounterMeaning> counter_meanings() noexcept;

/// Null if there is no such counter. O(counters).
[[nodiscard]] const CounterMeaning* find_counter(std::string_view unit, std::string_view name) noexcept;

}  // namespace octoskin
