// Descriptors that another program sent along are closed by threads of their own: what a close waits for is
// that program's choice, as a file system of its own, or a connection in a connection that is to linger.
#pragma once

#include <cstddef>

namespace octoskin::socketcan {

/// From so many on that are not closed yet nothing more is to be received that has descriptors beside it:
/// they are taken from those that this process may have.
inline constexpr std::size_t kClosingMax = 64;

/// Closes it soon, and never waits: a close that hangs holds up one of four threads, and where all hang what
/// comes then stays open. From any thread.
void close_beside(int descriptor);

/// So many were given to `close_beside` and are not closed yet.
[[nodiscard]] std::size_t closing();
[[nodiscard]] inline bool has_room_for_closing() {
    return closing() < kClosingMax;
}

}  // namespace octoskin::socketcan
