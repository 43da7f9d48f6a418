// Descriptors that come through a Unix socket, and that nobody asked for.
#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <span>

namespace octoskin::socketcan {

/// Closes those that came with this message, beside (descriptor_disposal.hpp): kept, they would be all that
/// this process may have, some day; and what a close waits for is their sender's choice. Never waits.
void close_passed(const msghdr& message);

/// Whether the next message of a Unix socket has descriptors beside it; false: there is none. It stays there.
[[nodiscard]] bool has_descriptors_beside(int descriptor);

/// recv(2) without waiting, of text, closing what comes beside it.
[[nodiscard]] ssize_t receive_text(int descriptor, std::span<char> bytes);

/// Closes a connection, and never waits. What was not read of it may hold descriptors, too: it is read
/// before; and where there is no room for closing them, the connection is closed beside, and they with it.
void close_connection(int descriptor);

}  // namespace octoskin::socketcan
