// What a helper allows itself before it opens anything. The libraries behind it may crash, run in circles or
// take all memory: that is why they run in a process of their own, and damaged input must not take the
// machine.
#pragma once

#include <cstdint>

namespace octoskin {

/// What becomes of a helper whose program ended.
enum class Orphan : std::uint8_t {
    is_killed,
    goes_on,  ///< by itself: its input ends
};

struct HelperLimits {
    std::uint64_t memory_mib = 0;  ///< of addresses; not limited in a build with sanitizers
    int exit_without_memory = 0;   ///< exit code when that is not enough
    Orphan orphan = Orphan::is_killed;
};

/// These limits, and no core dump. A pipe that closes is an error of its write, not the helper's end.
void limit_this_process(const HelperLimits& limits);

/// So many seconds of processor time in all: SIGXCPU, which says why, then SIGKILL a second later.
void limit_processor_seconds(std::uint64_t seconds);

/// So many seconds of processor time in all, whatever allow_processor_seconds() is asked for later: SIGXCPU
/// or, where that is ignored, SIGKILL.
void bound_processor_seconds(std::uint64_t seconds);

/// So many more seconds of processor time from now on: a helper that runs in circles ends even if nobody is
/// left to end it.
void allow_processor_seconds(unsigned seconds);

/// The files that it writes become so large at most: more is an error of the write.
void limit_file_size(std::uint64_t bytes);

/// Moves standard output to a descriptor of its own, which is returned; what the libraries print goes to
/// standard error and never into the result.
[[nodiscard]] int take_standard_output();

}  // namespace octoskin
