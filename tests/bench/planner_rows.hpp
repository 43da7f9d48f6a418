// Rows of a planner's questions about distances.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// The clearance of 100 postures of an arm, by search and with a distance field; and what following the map
/// takes the field after each further frame. `ten_frames`: the map of the room's first frames, made when a
/// row asks for it. `room` outlives the rows.
[[nodiscard]] std::vector<Row> planner_rows(const RoomFrames& room, const std::string& resolution,
                                            unsigned runs, std::function<const FusedMap&()> ten_frames);

}  // namespace octoskin::bench
