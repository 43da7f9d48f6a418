// Handles unrequested descriptors that arrive through a Unix socket. None is ever accepted: the kernel drops
// them, or refuses them to their sender if it can. Dropping may have to wait for a lingering connection; that
// wait is limited to some milliseconds (short_waits.hpp), so that a sender cannot block this process.
#pragma once

#include <sys/types.h>

#include <span>

namespace octoskin::socketcan {

/// From now on the kernel refuses descriptors to their sender (EPERM), at this Unix socket and at the
/// connections that it accepts. Since Linux 6.16; without effect before.
void refuse_descriptors(int socket);

/// Whether the next datagram of a Unix socket carries descriptors; false also if there is no datagram. The
/// datagram stays in the socket, which must be set up for time stamps and senders (stamped_datagram.hpp).
[[nodiscard]] bool has_descriptors_beside(int socket);

/// recv(2) of text from a connection; waits neither for the text nor for descriptors that come with it.
[[nodiscard]] ssize_t receive_text(int connection, std::span<char> bytes);

/// Reads what a connection has sent so far, at most about 64 KiB: unread data at the time of closing would
/// reset the connection before the other end has read its answer.
void read_the_rest(int connection);

/// close(2) of any Unix socket with everything that waits in it, without waiting for it.
void close_socket(int socket);

}  // namespace octoskin::socketcan
