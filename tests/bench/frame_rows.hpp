// Rows of one depth frame a run: each of our ways to integrate it, and the depth filter.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// Names end in `suffix`. `room` outlives the rows.
[[nodiscard]] std::vector<Row> frame_rows(const RoomFrames& room, const std::string& resolution,
                                          unsigned runs, const std::string& suffix);

}  // namespace octoskin::bench
