// Limits that a helper sets for itself before it opens a file. The libraries in it may crash, loop forever or
// allocate all memory. That is why they run in a process of their own: damaged input must not affect the
// machine.
#pragma once

#include <cstdint>

namespace octoskin {

/// The fate of a helper whose parent process ended.
enum class Orphan : std::uint8_t {
    is_killed,
    goes_on,  ///< by itself, at the end of its input
};

struct HelperLimits {
    std::uint64_t memory_mib = 0;  ///< address space; not limited in a build with sanitizers
    int exit_without_memory = 0;   ///< exit code if that is not enough
    Orphan orphan = Orphan::is_killed;
};

/// Sets these limits, and disables core dumps. Writing to a closed pipe becomes a write error and does not
/// end the helper.
void limit_this_process(const HelperLimits& limits);

/// Limits the total processor time: SIGXCPU, which shows the reason, then SIGKILL a second later.
void limit_processor_seconds(std::uint64_t seconds);

/// Limits the total processor time, independent of later calls of allow_processor_seconds(): SIGXCPU, or
/// SIGKILL where that is ignored.
void bound_processor_seconds(std::uint64_t seconds);

/// Allows this much more processor time from now on: a helper that loops forever ends even if no process is
/// left to end it.
void allow_processor_seconds(unsigned seconds);

/// Limits the size of written files: beyond it a write fails.
void limit_file_size(std::uint64_t bytes);

/// Moves standard output to another descriptor and returns it. Output of the libraries then goes to standard
/// error and cannot enter the result.
[[nodiscard]] int take_standard_output();

}  // namespace octoskin
