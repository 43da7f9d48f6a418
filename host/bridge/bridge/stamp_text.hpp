// What is wrong with a sender's clock, for a person.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "host/apps/daemon/clocks.hpp"

namespace octoskin::bridge {

/// `what`: "its images"; `age`: how far the newest refused stamp is behind this machine's clock; negative:
/// ahead. `refused` of `received` lately. Empty if there is no problem.
[[nodiscard]] inline std::string stamp_problem(const std::string& what, std::uint64_t refused,
                                               std::uint64_t received, Nanoseconds age) {
    constexpr double kFew = 0.05;
    constexpr double kMost = 0.5;
    const double share = received == 0 ? 0.0 : static_cast<double>(refused) / static_cast<double>(received);
    if (share <= kFew) return {};
    if (share < kMost)
        return fmt::format(
            "{} come late: {} of {} by more than 150 ms: is this machine or the network too busy?", what,
            refused, received);
    const double seconds = seconds_of(age);
    return fmt::format(
        "{} have stamps {:.3f} s {} this machine's clock and are not used: synchronise both clocks "
        "(chrony or PTP)",
        what, seconds < 0.0 ? -seconds : seconds, seconds < 0.0 ? "ahead of" : "behind");
}

}  // namespace octoskin::bridge
