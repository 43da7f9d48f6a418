// What a helper may still ask the kernel for once it reads a foreign file with a library: a library that the
// file has taken over gets no further than the helper's output.
#pragma once

namespace octoskin {

/// From now on this process and all its threads may read files, write to what is open already, and have
/// memory, time and threads. All else ends it by SIGSYS: no program is started, no socket made, nothing
/// opened for writing, no other process touched. There is no way back. Where the kernel refuses to do so it
/// goes on as before, and `program` says so on standard error; so it does, without a word, in a build with
/// sanitizers, whose own work needs more.
void confine_this_process(const char* program);

}  // namespace octoskin
