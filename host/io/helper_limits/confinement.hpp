// Restricts a helper's system calls while it reads an untrusted file with a library. If the file takes over
// the library, it gains access to nothing but the helper's output.
#pragma once

#include <cstdint>

namespace octoskin {

/// Whether a confined process may start further threads. Their number is limited only by its memory.
enum class NewThreads : std::uint8_t { refused, allowed };

/// From now on this process and all its threads may only read files, write to open descriptors, allocate
/// memory, read the time and, if allowed, start threads. Any other system call ends the process by SIGSYS: it
/// cannot start a program, make a socket, open a file for writing, or touch another process. This cannot be
/// undone.
/// As far as the kernel permits, this thread and threads that it starts cannot inspect other processes
/// either, and of root's rights they keep only that to read files (privileges.hpp).
/// If the kernel refuses, the process continues without confinement, a message of `program` appears on
/// standard error, and the result is false. In a build with sanitizers, which need more calls, the same
/// happens without a message.
bool confine_this_process(const char* program, NewThreads threads);

}  // namespace octoskin
