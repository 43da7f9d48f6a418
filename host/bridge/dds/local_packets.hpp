// Keeps a program's UDP sockets to this machine: the kernel drops what comes from other machines.
#pragma once

namespace octoskin::dds {

/// Each IPv4 UDP socket of this process from now on receives only from the present addresses of this machine.
/// Call it again when addresses may have changed. False: the kernel refused it for a socket.
[[nodiscard]] bool receive_from_this_machine_only();

}  // namespace octoskin::dds
