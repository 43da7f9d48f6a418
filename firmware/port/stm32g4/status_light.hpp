// The board's light: short flashes, counted every two seconds, say how the board is; while somebody asks for
// it by the `identify` command, it blinks evenly instead.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "firmware/core/ports.hpp"
#include "firmware/port/stm32g4/pin.hpp"

namespace octoskin::stm32g4 {

/// Its value is the number of flashes.
enum class Flashes : std::uint8_t {
    all_is_well = 1,
    no_crystal = 2,  ///< silent on CAN
    bad_config = 3,  ///< no ranging
    can_fault = 4,   ///< CAN is out of order
    no_ranges = 5,   ///< of a sensor, of a bus, or of the whole node
};

class StatusLight final : public node::Indicator {
  public:
    void start();
    void show(Flashes flashes) { flashes_ = flashes; }

    /// The node's own blinking, which goes before the flashes for a second each time.
    void set(bool is_on) override;
    /// Puts the light into the state that is due. Returns when to call it next.
    NodeTime poll(NodeTime now);

  private:
    Flashes flashes_ = Flashes::all_is_well;
    std::optional<bool> ordered_;  ///< by the node, not yet seen by `poll`
    std::optional<NodeTime> identify_until_;
};

}  // namespace octoskin::stm32g4
