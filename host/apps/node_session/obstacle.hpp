// What a node's state means for a user who commands it.
#pragma once

#include <optional>

#include "common/wire/messages.hpp"
#include "host/errors/error.hpp"

namespace octoskin {

/// Why a node in this state does not range, and the remedy. Empty if it ranges, or would range after a
/// command to start.
[[nodiscard]] std::optional<Error> obstacle(wire::NodeState state);

/// The error of a node that reports `commands_refused` in NODE_INFO.
[[nodiscard]] Error commands_refused();

}  // namespace octoskin
