// Brings the board onto the CAN bus, and again whenever it is not there: at the configuration's rates or, if
// nobody told them, at those found by listening. What fails is tried again once a second.
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
    /// Between two tries. The first after a long time on the bus is made at once.
    static constexpr Microseconds kPause{1'000'000};

    constexpr explicit CanEntry(CanController& can) : can_(can) {}

    /// Makes the first try. Without `rates` it looks for them. With `clock_hz` 0 it never tries: CAN stays
    /// silent.
    void begin(const std::optional<CanRates>& rates, wire::NodeId node_id, std::uint32_t clock_hz,
               NodeTime now);
    /// Call after `CanController::poll`, in every turn of the loop.
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
