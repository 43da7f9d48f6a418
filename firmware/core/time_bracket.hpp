// An instant known only to lie between two times of the node's clock.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace octoskin::node {

struct TimeBracket {
    NodeTime earliest;
    NodeTime latest;  ///< not before `earliest`

    [[nodiscard]] constexpr Microseconds width() const noexcept { return elapsed(earliest, latest); }
    [[nodiscard]] constexpr NodeTime middle() const noexcept { return earliest + width() / 2; }
    /// Bound on the error of `middle()`.
    [[nodiscard]] constexpr Microseconds half_width() const noexcept {
        return (width() + Microseconds{1}) / 2;
    }
    [[nodiscard]] constexpr bool contains(NodeTime time) const noexcept {
        return is_reached(earliest, time) && is_reached(time, latest);
    }
    friend constexpr bool operator==(const TimeBracket&, const TimeBracket&) = default;
};

[[nodiscard]] constexpr NodeTime later_of(NodeTime a, NodeTime b) noexcept {
    return is_reached(a, b) ? b : a;
}
[[nodiscard]] constexpr NodeTime earlier_of(NodeTime a, NodeTime b) noexcept {
    return is_reached(a, b) ? a : b;
}

[[nodiscard]] constexpr TimeBracket shifted(const TimeBracket& bracket, Microseconds by) noexcept {
    return {bracket.earliest + by, bracket.latest + by};
}

[[nodiscard]] constexpr TimeBracket widened(const TimeBracket& bracket, Microseconds by) noexcept {
    return {bracket.earliest - by, bracket.latest + by};
}

/// The common part; empty if the two contradict each other.
[[nodiscard]] constexpr std::optional<TimeBracket> intersection(const TimeBracket& a,
                                                                const TimeBracket& b) noexcept {
    const TimeBracket both{later_of(a.earliest, b.earliest), earlier_of(a.latest, b.latest)};
    if (!is_reached(both.earliest, both.latest)) return std::nullopt;
    return both;
}

}  // namespace octoskin::node
