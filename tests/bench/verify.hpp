// The exact integrator against OctoMap, key by key.
#pragma once

#include <string>

#include "tests/bench/room_frames.hpp"

namespace octoskin::bench {

/// Compares hit and passed voxels of the first `frames` frames with OctoMap's `computeUpdate`; prints a line.
/// False if any is missing or too many.
[[nodiscard]] bool verify(const RoomFrames& room, const std::string& resolution, unsigned frames);

}  // namespace octoskin::bench
