// How the effect of a command shows in the node's messages, and why a node refuses a command.
#pragma once

#include "host/apps/command/node_view.hpp"
#include "host/errors/error.hpp"

namespace octoskin::commanding {

/// Whether everything that the command changes has changed. `now` contains the messages since the command.
/// Not for `reset`, which ends the run that `now` describes.
[[nodiscard]] bool is_in_effect(const Order& order, const NodeView& now, bool has_sent_black_box);

/// Why the node refuses this command: the reason and the remedy.
[[nodiscard]] Error refusal(const Order& order, const NodeView& view);

}  // namespace octoskin::commanding
