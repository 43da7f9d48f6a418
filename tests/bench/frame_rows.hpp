// Rows of one depth frame a run: OctoMap's integration, each of ours, and the depth filter.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// Of OctoMap's runs there are at most `runs_octomap`. Names end in `suffix`. `room` outlives the rows.
[[nodiscard]] std::vector<Row> frame_rows(const RoomFrames& room, const std::string& resolution,
                                          unsigned runs, unsigned runs_octomap, const std::string& suffix);

}  // namespace octoskin::bench
