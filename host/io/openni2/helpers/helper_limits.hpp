// What a helper allows itself before it opens anything: a damaged recording must not take the machine.
#pragma once

namespace octoskin::openni2 {

/// 2 GiB of memory, no core dump, and no helper outlives the program that started it. A pipe that closes is
/// an error of its write, not the helper's end.
void limit_this_process();

/// So many more seconds of processor time from now on: a helper that runs in circles ends even if nobody is
/// left to end it.
void allow_processor_seconds(unsigned seconds);

/// Moves standard output to a descriptor of its own, which is returned; what OpenNI2 prints goes to standard
/// error and never between the frames.
[[nodiscard]] int take_standard_output();

}  // namespace octoskin::openni2
