#include "host/apps/node_session/obstacle.hpp"

namespace octoskin {

const char* obstacle(wire::NodeState state) {
    switch (state) {
        case wire::NodeState::safe:
            return "it is in safe mode after repeated resets, and NODE_INFO names the fault: the command "
                   "'start', or one minute of waiting, ends safe mode";
        case wire::NodeState::bad_config:
            return "it has no valid configuration for its board: flash it";
        case wire::NodeState::id_conflict:
            return "another board uses the same node id: remove one of the two from the bus";
        case wire::NodeState::bus_fault:
            return "none of its I2C buses works: look for a line that is held low or shorted";
        case wire::NodeState::starting:
        case wire::NodeState::ranging:
        case wire::NodeState::stopped:
        case wire::NodeState::can_fault:
            return nullptr;
    }
    return nullptr;
}

}  // namespace octoskin
