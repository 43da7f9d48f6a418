// Detects that something has come too close to a sensor. Each event is reported once; it is over when the
// sensor has seen nothing near its limit for a while. Only a hit counts as close. Only a hit farther off, or
// a reading without a target, counts as far; a reading with a fault counts as neither.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/reading.hpp"

namespace octoskin::node {

class Reflex {
  public:
    /// `limit_mm` 0: never.
    Reflex(std::uint16_t limit_mm, const Policy& policy) noexcept : limit_mm_(limit_mm), policy_(policy) {}

    /// Takes every accepted reading, in order. True if an event begins with it. O(1).
    [[nodiscard]] bool begins(const Reading& reading, NodeTime now) noexcept;

    /// The event was not sent in time: the next reading below the limit begins a new one.
    void rearm() noexcept { is_armed_ = true; }

    /// Call at least every 35 minutes, with or without readings.
    void update(NodeTime now) noexcept;

  private:
    [[nodiscard]] bool is_far(const Reading& reading) const noexcept;

    std::uint16_t limit_mm_;
    const Policy& policy_;
    bool is_armed_ = true;
    std::optional<NodeTime> far_since_;
};

}  // namespace octoskin::node
