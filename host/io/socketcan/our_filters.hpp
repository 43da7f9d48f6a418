// Which identifiers a host lets the kernel pass: those of its own rig, and every node's heartbeat, so that a
// node of another rig is named. Whatever else floods the bus never wakes it.
#pragma once

#include <vector>

#include "host/core/rig/host_rig.hpp"
#include "host/io/socketcan/can_socket.hpp"

namespace octoskin::socketcan {

[[nodiscard]] std::vector<IdFilter> our_filters(const HostRig& rig);

}  // namespace octoskin::socketcan
