// When a node that the bus has shut out may try again: 100 ms after it went bus-off, then 200, 400 and 800,
// and every 800 from there on; once it has stayed on the bus for a second, from 100 anew. The controller of
// the STM32G4 (RM0440, FDCAN) recovers only when software asks for it, so nobody hurries.
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
        discard,  ///< it has just gone bus-off: what waits in the controller is about to be stale
        restart,  ///< let the controller begin its way back
        resume,   ///< it is back
    };

    explicit BusOffRecovery(const Policy& policy) noexcept;

    /// Call at every turn with the controller's state.
    [[nodiscard]] Action update(CanState state, NodeTime now) noexcept;
    [[nodiscard]] bool is_off() const noexcept { return is_off_; }
    /// Bus-off now, or back for less than `can_proven`.
    [[nodiscard]] bool is_recent() const noexcept { return is_off_ || back_since_.has_value(); }
    /// When `update` next has something to do of its own accord.
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
