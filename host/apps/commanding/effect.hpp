// How the effect of a command shows in what its node says, and why a node refuses one.
#pragma once

#include <string>

#include "host/apps/commanding/node_view.hpp"

namespace octoskin::commanding {

/// Whether all that the command changes has changed. `now` holds what was said since the command. Not for
/// `reset`, which ends the run that this looks at.
[[nodiscard]] bool is_in_effect(const Order& order, const NodeView& now, bool has_sent_black_box);

/// What the refusal of this command means, for a person: why, and what to do.
[[nodiscard]] std::string refusal(const Order& order, const NodeView& view);

}  // namespace octoskin::commanding
