// Decides whether so much of an input was rejected that the user should see why.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "host/core/counters/input_counters.hpp"

namespace octoskin {

/// More than half of an input was rejected.
struct Loss {
    std::string title;           ///< CounterTable::title()
    std::string unit;            ///< "readings"
    std::uint64_t rejected = 0;  ///< of `of`
    std::uint64_t of = 0;
    /// True: more than half of the usable inputs were lost for reasons that a user can correct. False: the
    /// scene or other devices on the bus explain it.
    bool is_mendable = false;
    std::string reason;       ///< the counter's name of the most frequent of these reasons
    std::uint64_t count = 0;  ///< how many inputs it rejected
    std::string first;        ///< place of the first of them; empty: not known
};

/// Evaluates the rejections by the causes of counter_meanings(). Usable inputs are those used, those pending,
/// and those lost for a mendable cause. Empty if no cause rejected more than half, or if pending inputs may
/// still change that. O(reasons).
[[nodiscard]] std::optional<Loss> loss_of(const CounterTable& table);

/// The most frequent reason, of any cause and count. Empty if nothing was rejected.
[[nodiscard]] std::optional<Loss> most_frequent(const CounterTable& table);

/// The remedy as a sentence with a leading space: " Give the rig with the camera." Empty if there is none.
[[nodiscard]] std::string remedy_sentence(std::string_view unit, std::string_view name);

/// "readings: 2315 of 2643 are lost, most as clock_in_doubt (2310, the first at 12.3 s): MEANING. REMEDY."
[[nodiscard]] std::string describe(const Loss& loss);

}  // namespace octoskin
