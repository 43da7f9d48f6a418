// What an adapter's error frames say of its controller: <linux/can/error.h>.
#pragma once

#include "common/wire/can_frame.hpp"
#include "firmware/core/ports.hpp"

namespace octoskin::linux_port {

/// The state after an error frame, which was `before`: a frame that is about something else leaves it.
/// `frame.is_error` must hold.
[[nodiscard]] node::CanState state_after(const wire::CanFrame& frame, node::CanState before) noexcept;

}  // namespace octoskin::linux_port
