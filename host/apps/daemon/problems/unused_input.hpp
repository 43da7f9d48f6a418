// Of what comes in and is not used: whether it has stopped, and where its reason stands.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"
#include "host/core/account/account.hpp"

namespace octoskin {

/// Whether it was used before, and has not been for 0.8 s.
inline bool has_stopped(const std::optional<HostTime>& last, HostTime now) {
    constexpr Nanoseconds kPatience{800'000'000};
    return last && now - *last > kPatience;
}

/// Where to look, and the most frequent reason, which is why as often as not.
template <class Reject>
std::string see_counters(const char* unit, const Account<Reject>& account) {
    constexpr auto kNames = names_of(Reject{});
    std::size_t most = 0;
    for (std::size_t i = 1; i < kNames.size(); ++i) {
        if (account.rejected(static_cast<Reject>(i)) > account.rejected(static_cast<Reject>(most))) most = i;
    }
    const std::uint64_t count = account.rejected(static_cast<Reject>(most));
    const std::string where = fmt::format("see the counters of {}", unit);
    return count == 0 ? where
                      : fmt::format("{} (most often {}, {} of {})", where, kNames[most], count, account.in());
}

}  // namespace octoskin
