// Rows of all that a depth frame costs its user, from the camera's millimetres to the map.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// A row for each way to integrate a frame, compared with OctoMap's integration of the same raw frame, and
/// with the times of its steps. Names end in `suffix`. `room` outlives the rows.
[[nodiscard]] std::vector<Row> whole_rows(const RoomFrames& room, const std::string& resolution,
                                          unsigned runs, const std::string& suffix);

}  // namespace octoskin::bench
