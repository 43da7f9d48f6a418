#include "firmware/port/linux/can_errors.hpp"

#include <linux/can/error.h>

namespace octoskin::linux_port {

node::CanState state_after(const wire::CanFrame& frame, node::CanState before) noexcept {
    if ((frame.can_id & CAN_ERR_BUSOFF) != 0) return node::CanState::bus_off;
    if ((frame.can_id & CAN_ERR_RESTARTED) != 0) return node::CanState::active;
    if ((frame.can_id & CAN_ERR_CRTL) == 0 || before == node::CanState::bus_off) return before;
    constexpr unsigned kPassive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
    constexpr unsigned kActive = CAN_ERR_CRTL_ACTIVE | CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;
    if ((frame.data[1] & kPassive) != 0) return node::CanState::passive;
    if ((frame.data[1] & kActive) != 0) return node::CanState::active;
    return before;
}

}  // namespace octoskin::linux_port
