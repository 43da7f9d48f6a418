// The one table of the input counters: the meaning, the cause and the remedy of each.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace octoskin {

/// Why an input was rejected, and thereby whether a user can change it.
enum class Cause : std::uint8_t {
    scene,         ///< explained by the scene: out of range, no target, the robot itself
    outside,       ///< outside the marks, before the first clock exchange, or not needed with this rig
    other_device,  ///< not for this host: other traffic on the bus, or a message to others
    mendable,      ///< a user can correct it: rig, recording, wiring, or a second sender
};

struct CounterMeaning {
    std::string_view unit;
    std::string_view name;
    std::string_view text;
    Cause cause = Cause::mendable;
    std::string_view remedy;  ///< an imperative without a full stop; empty: there is no remedy
};

/// The meanings of all counters of all units. Units and names are those of CounterTable. docs/counters.md has
/// the same table.
[[nodiscard]] std::span<const CounterMeaning> counter_meanings() noexcept;

/// `unit`: of a CounterTable, or its title. Returns null if there is no such counter. O(counters).
[[nodiscard]] const CounterMeaning* find_counter(std::string_view unit, std::string_view name) noexcept;

}  // namespace octoskin
