// When a node that went bus-off may try again: after 100 ms, then 200, 400 and 800, then every 800 ms. After
// a second on the bus the sequence starts again at 100 ms. The controller of the STM32G4 (RM0440, FDCAN)
// recovers only when software requests it.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/policy.hpp"
#include "firmware/core/ports.hpp"

namespace octoskin::node {

class BusOffRecovery {
  public:
    enum class Action : std::uint8_t {
        none,
        discard,  ///< just gone bus-off: frames in the controller are about to become stale
        restart,  ///< let the controller begin its recovery
        resume,   ///< back on the bus
    };

    explicit BusOffRecovery(const Policy& policy) noexcept;

    /// Call at every turn with the controller's state.
    [[nodiscard]] Action update(CanState state, NodeTime now) noexcept;
    [[nodiscard]] bool is_off() const noexcept { return is_off_; }
    /// Bus-off now, or back for less than `can_proven`.
    [[nodiscard]] bool is_recent() const noexcept { return is_off_ || back_since_.has_value(); }
    /// When `update` next has something to do without a change of state.
    [[nodiscard]] std::optional<NodeTime> wake_time() const noexcept;
    [[nodiscard]] std::uint32_t count() const noexcept { return count_; }

  private:
    [[nodiscard]] Action on_off(NodeTime now) noexcept;

    const Policy& policy_;
    bool is_off_ = false;
    NodeTime try_at_;
    Microseconds wait_;
    std::optional<NodeTime> back_since_;
    std::uint32_t count_ = 0;
};

}  // namespace octoskin::node
