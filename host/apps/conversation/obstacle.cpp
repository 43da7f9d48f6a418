#include "host/apps/conversation/obstacle.hpp"

namespace octoskin {

const char* obstacle(wire::NodeState state) {
    switch (state) {
        case wire::NodeState::safe:
            return "it is in safe mode after repeated resets: its NODE_INFO names the fault; the command "
                   "'start' or a minute's wait ends it";
        case wire::NodeState::bad_config:
            return "it has no valid configuration for its board: flash it";
        case wire::NodeState::id_conflict:
            return "another board sends under its node id: take one of the two off the bus";
        case wire::NodeState::bus_fault:
            return "none of its I2C buses can be used: look for a line that is held or shorted";
        case wire::NodeState::starting:
        case wire::NodeState::ranging:
        case wire::NodeState::stopped:
        case wire::NodeState::can_fault:
            return nullptr;
    }
    return nullptr;
}

}  // namespace octoskin
