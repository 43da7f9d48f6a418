// Rows of what is done with a map besides giving it depth frames, ours beside OctoMap's of the same voxels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// Beams: a cycle of 34. Of the room's first frames as `exact`: a copy, as octomap::OcTree and what the next
/// frame changes in that, to a .ot and back, 100,000 questions for a point, 100 postures of an arm. Files go
/// to `folder`, which the caller removes. `room` outlives the rows.
[[nodiscard]] std::vector<Row> map_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                                        const std::filesystem::path& folder);

}  // namespace octoskin::bench
