// Descriptors that come through a Unix socket, and that nothing asked for. None is ever taken: the kernel
// drops them, where it cannot refuse them to their sender. A drop may have to wait, for a connection that
// lingers: it is made to wait for some milliseconds at most (short_waits.hpp), so that no sender can hold up
// this process.
#pragma once

#include <sys/types.h>

#include <span>

namespace octoskin::socketcan {

/// From now on the kernel refuses them to their sender (EPERM), at this Unix socket and at the connections
/// that it takes: of Linux 6.16. Before that it does nothing.
void refuse_descriptors(int socket);

/// Whether the next datagram of a Unix socket that wants stamps and senders (stamped_datagram.hpp) has
/// descriptors beside it; false: there is none. It stays there.
[[nodiscard]] bool has_descriptors_beside(int socket);

/// recv(2) of a connection, of text; waits neither for it nor for what comes beside it.
[[nodiscard]] ssize_t receive_text(int connection, std::span<char> bytes);

/// Reads what a connection has sent until now, some 64 KiB at most: what is left unread when it is closed
/// breaks it for its other end, which has an answer to read.
void read_the_rest(int connection);

/// close(2) of any Unix socket, with all that waits in it; waits for none of it.
void close_socket(int socket);

}  // namespace octoskin::socketcan
