// Between the CAN controller and whoever plays the bus: arbitration is the bus's, retransmission and error
// counting the controller's.
#pragma once

#include <cstdint>
#include <optional>

#include "common/wire/bus_load.hpp"
#include "common/wire/can_frame.hpp"

namespace octoskin::sim::stm32 {

/// What the transceiver and the others make of our frames.
enum class CanLink : std::uint8_t {
    good,
    nobody_acknowledges,  ///< alone on the bus
    broken,               ///< every bit that is sent reads back wrong: a short circuit
};

/// The bus as the controller sees it.
class CanBusSide {
  public:
    /// The frame that the controller wants to send next, or none; replaces what was offered before. A frame
    /// that the bus has begun ends in any case.
    virtual void offer(const std::optional<wire::CanFrame>& frame) = 0;

  protected:
    ~CanBusSide() = default;
};

}  // namespace octoskin::sim::stm32
