// What a helper allows itself before it opens anything: a damaged recording must not take the machine.
#pragma once

#include <cstdint>

namespace octoskin::openni2 {

/// What becomes of a helper whose program ended.
enum class Orphan : std::uint8_t {
    is_killed,
    goes_on,  ///< by itself: its input ends
};

/// 2 GiB of memory, no core dump. A pipe that closes is an error of its write, not the helper's end.
void limit_this_process(Orphan orphan = Orphan::is_killed);

/// So many more seconds of processor time from now on: a helper that runs in circles ends even if nobody is
/// left to end it.
void allow_processor_seconds(unsigned seconds);

/// Moves standard output to a descriptor of its own, which is returned; what OpenNI2 prints goes to standard
/// error and never between the frames.
[[nodiscard]] int take_standard_output();

}  // namespace octoskin::openni2
