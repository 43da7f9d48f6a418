// Rows of what a reading costs, from where the robot is to the fused map: a sensor that sees a cone, or zones
// of one, with an arm that moves or is stationary, beside single rays.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "tests/bench/task.hpp"

namespace octoskin::bench {

/// A run is a reading of each of the 34 sensors of the experiment's rigs in `rigs`. `map`: what the maps
/// begin with; asked for only by rows that are made.
[[nodiscard]] std::vector<Row> reading_rows(const std::filesystem::path& rigs, const std::string& resolution,
                                            unsigned runs, const std::function<const FusedMap&()>& map);

}  // namespace octoskin::bench
