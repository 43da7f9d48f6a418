#include "host/apps/node_session/obstacle.hpp"

namespace octoskin {

std::optional<Error> obstacle(wire::NodeState state) {
    switch (state) {
        case wire::NodeState::safe:
            return Error{.code = ErrorCode::no_device,
                         .what = "it is in safe mode after repeated resets, and NODE_INFO names the fault",
                         .remedy = "the command 'start', or one minute of waiting, ends safe mode"};
        case wire::NodeState::bad_config:
            return Error{.code = ErrorCode::mismatch,
                         .what = "it has no valid configuration for its board",
                         .remedy = "flash it"};
        case wire::NodeState::id_conflict:
            return Error{.code = ErrorCode::duplicate,
                         .what = "another board uses the same node id",
                         .remedy = "remove one of the two from the bus"};
        case wire::NodeState::bus_fault:
            return Error{.code = ErrorCode::no_device,
                         .what = "none of its I2C buses works",
                         .remedy = "look for a line that is held low or shorted"};
        case wire::NodeState::starting:
        case wire::NodeState::ranging:
        case wire::NodeState::stopped:
        case wire::NodeState::can_fault:
            return std::nullopt;
    }
    return std::nullopt;
}

Error commands_refused() {
    return {.code = ErrorCode::no_permission,
            .what = "it refuses all commands, because its rig has `refuses_commands: true` at this node",
            .remedy = "remove `refuses_commands` from the rig and flash the node"};
}

}  // namespace octoskin
