// The file beside a world's SDF that defines which models move.
//
//     models:
//       - model: ball                       # of the SDF
//         places:                           # before the first, where the SDF has it
//           - {at_s: 0, is_there: false}
//           - {at_s: 2.5}                   # it appears
//           - {at_s: 4, moves_on: true}     # and is carried off: at one speed to the next place
//           - {at_s: 6, offset_m: [0, 1, 0]}
#pragma once

#include <filesystem>
#include <vector>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/world/moving_world.hpp"

namespace octoskin::sim {

/// As strictly as read_scenario(): an unknown key, a time that is not later than the one before, a model that
/// occurs twice or is not one of `solids` is an error, with its line. Seconds from the start of the arm's
/// motion; -600 or greater.
[[nodiscard]] Result<std::vector<ModelMotion>, Error> read_motion(const FilePlace& file,
                                                                  const std::vector<Solid>& solids);

}  // namespace octoskin::sim
