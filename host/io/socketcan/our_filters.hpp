// The identifiers that the kernel passes to a host: those of its own rig, and the heartbeats of all nodes, so
// that a node of another rig can be reported. Other traffic never wakes the host.
#pragma once

#include <vector>

#include "host/core/rig/host_rig.hpp"
#include "host/io/socketcan/can_socket.hpp"

namespace octoskin::socketcan {

[[nodiscard]] std::vector<IdFilter> our_filters(const HostRig& rig);

}  // namespace octoskin::socketcan
