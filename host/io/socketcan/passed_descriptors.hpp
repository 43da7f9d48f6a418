// Descriptors that come through a Unix socket, and that nobody asked for.
#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <span>

namespace octoskin::socketcan {

/// Closes those that came with this message: kept, they would be all that this process may have, some day.
/// Each loses its SO_LINGER before: else closing the last descriptor of a connection waits, for hours if its
/// sender wants that. Calls nothing else that waits; what a file system of its sender's makes of a close is
/// not known here.
void close_passed(const msghdr& message);

/// recv(2) without waiting, of text, closing what comes beside it.
[[nodiscard]] ssize_t receive_text(int descriptor, std::span<char> bytes);

/// Closes a connection. What was not read of it may hold descriptors, too: it is read before, as much as a
/// sender can have left there.
void close_connection(int descriptor);

}  // namespace octoskin::socketcan
