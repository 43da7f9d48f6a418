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

/// Whether it was used before, and has not been for 0.8 s.
inline bool has_stopped(const std::optional<HostTime>& last, HostTime now) {
    constexpr Nanoseconds kPatience{800'000'000};
    return last && now - *last > kPatience;
}

/// The most frequent reason, its meaning and its remedy.
template <class Reject>
std::string see_counters(const char* unit, const InputCounters<Reject>& inputs) {
    const auto loss = most_frequent(tabulate(unit, inputs));
    return loss ? describe(*loss) : fmt::format("see the counters of {}", unit);
}

}  // namespace octoskin
