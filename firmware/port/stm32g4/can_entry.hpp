// Joins the CAN bus, and joins it again after a failure: at the configured rates or, without a configuration,
// at rates found by listening. A failed try is repeated once a second.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "firmware/port/stm32g4/can_bit_timing.hpp"
#include "firmware/port/stm32g4/can_controller.hpp"
#include "firmware/port/stm32g4/rate_search.hpp"

namespace octoskin::stm32g4 {

class CanEntry {
  public:
    /// Time between two tries. After longer than this on the bus, the first try is immediate.
    static constexpr Microseconds kPause{1'000'000};

    constexpr explicit CanEntry(CanController& can) : can_(can) {}

    /// Makes the first try. Without `rates` it searches for them. With `clock_hz` 0 it never tries, and CAN
    /// stays silent.
    void begin(const std::optional<CanRates>& rates, wire::NodeId node_id, std::uint32_t clock_hz,
               NodeTime now);
    /// Call after `CanController::poll`, once per turn of the loop.
    void poll(NodeTime now);

  private:
    void enter(NodeTime now);
    void judge(NodeTime now);

    CanController& can_;
    std::optional<CanRates> rates_;
    RateSearch search_;
    wire::NodeId node_id_ = 0;
    std::uint32_t clock_hz_ = 0;
    NodeTime try_at_;
    bool has_paused_ = false;
};

}  // namespace octoskin::stm32g4
