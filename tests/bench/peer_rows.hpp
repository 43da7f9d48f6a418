// What else a user could integrate a depth frame with: OctoMap, and a grid written in an hour.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/room_frames.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// The row that the others of a frame are compared with.
inline constexpr const char* kOctomap = "octomap";

/// `runs`: of the dense grid; of OctoMap's there are at most `runs_octomap`. Names end in `suffix`. `room`
/// outlives the rows. Of frames from one place OctoMap's defaults only.
[[nodiscard]] std::vector<Row> peer_rows(const RoomFrames& room, const std::string& resolution, unsigned runs,
                                         unsigned runs_octomap, const std::string& suffix);

}  // namespace octoskin::bench
