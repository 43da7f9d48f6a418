// The interface between the CAN controller and the model of the bus. The bus does arbitration; the controller
// does retransmission and error counting.
#pragma once

#include <cstdint>
#include <optional>

#include "common/wire/bus_load.hpp"
#include "common/wire/can_frame.hpp"

namespace octoskin::sim::stm32 {

/// State of the link for transmitted frames.
enum class CanLink : std::uint8_t {
    good,
    unacknowledged,  ///< alone on the bus
    broken,          ///< every bit that is sent reads back wrong: a short circuit
};

/// The bus side of the controller.
class CanBusSide {
  public:
    /// The frame that the controller wants to send next, or none; replaces what was offered before. A frame
    /// on the bus is always completed.
    virtual void offer(const std::optional<wire::CanFrame>& frame) = 0;

  protected:
    ~CanBusSide() = default;
};

}  // namespace octoskin::sim::stm32
