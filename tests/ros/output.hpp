// One JSON object a line on standard output, each with "event" first, from any thread.
#pragma once

#include "tests/ros/codec.hpp"

namespace octoskin::ros {

/// Writes and flushes one line.
void print(const Json& event);

/// Whether SIGINT or SIGTERM came since this was called first, which catches them.
[[nodiscard]] bool is_told_to_end();

}  // namespace octoskin::ros
