// Inputs that are not used: whether they have stopped, and the reason.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "host/core/counters/input_counters.hpp"
#include "host/core/counters/loss.hpp"

namespace octoskin {

inline constexpr Nanoseconds kUnusedPatience{800'000'000};

/// Whether it was used before, and has not been for longer than `patience`.
inline bool has_stopped(const std::optional<HostTime>& last, HostTime now,
                        Nanoseconds patience = kUnusedPatience) {
    return last && now - *last > patience;
}

/// The most frequent reason, its meaning and its remedy.
inline std::string see_counters(const CounterTable& table) {
    const auto loss = most_frequent(table);
    return loss ? describe(*loss) : fmt::format("see the counters of {}", table.title());
}
template <class Reject>
std::string see_counters(const char* unit, const InputCounters<Reject>& inputs) {
    return see_counters(tabulate(unit, inputs));
}

}  // namespace octoskin
