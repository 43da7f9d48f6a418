// The board's light. The number of short flashes in each period of two seconds shows the board's state.
// During the `identify` command the light blinks evenly instead.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/port/stm32g4/pin.hpp"

namespace octoskin::stm32g4 {

/// The value is the number of flashes.
enum class Flashes : std::uint8_t {
    all_is_well = 1,
    no_crystal = 2,  ///< silent on CAN
    bad_config = 3,  ///< no ranging
    can_fault = 4,   ///< CAN does not work
    no_ranges = 5,   ///< a sensor, a bus, or the whole node does not range
};

class StatusLight final : public node::Indicator {
  public:
    void start();
    void show(Flashes flashes) { flashes_ = flashes; }

    /// Called by the node for `identify`; replaces the flashes for one second each time.
    void set(bool is_on) override;
    /// Sets the light to its current state. Returns the time of the next call.
    NodeTime poll(NodeTime now);

  private:
    Flashes flashes_ = Flashes::all_is_well;
    std::optional<bool> ordered_;  ///< set by the node, not yet handled by `poll`
    std::optional<NodeTime> identify_until_;
};

}  // namespace octoskin::stm32g4
