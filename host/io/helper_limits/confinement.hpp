// What a helper may still ask the kernel for once it reads a foreign file with a library: a library that the
// file has taken over gets no further than the helper's output.
#pragma once

#include <cstdint>

namespace octoskin {

/// Whether a process that is confined may begin more threads. How many, nothing limits but its memory.
enum class NewThreads : std::uint8_t { refused, allowed };

/// From now on this process and all its threads may read files, write to what is open already, and have
/// memory, time and, if allowed, threads. All else ends it by SIGSYS: no program is started, no socket made,
/// nothing opened for writing, no other process touched. There is no way back. As far as the kernel can, this
/// thread and those that it begins may not look into another process either, and of root's rights keep that
/// to read (privileges.hpp). Where the kernel refuses to do so it
/// goes on as before, and `program` says so on standard error and false is returned; so it does, without a
/// word, in a build with sanitizers, whose own work needs more.
bool confine_this_process(const char* program, NewThreads threads);

}  // namespace octoskin
