// Controller state from an adapter's error frames: <linux/can/error.h>.
#pragma once

#include "common/wire/can_frame.hpp"
#include "firmware/core/ports.hpp"

namespace octoskin::linux_port {

/// The state after an error frame; `before` is the state before it. An unrelated error frame does not change
/// the state. Precondition: `frame.is_error`.
[[nodiscard]] node::CanState state_after(const wire::CanFrame& frame, node::CanState before) noexcept;

}  // namespace octoskin::linux_port
