// The checks of an SDF file that need no sdformat, and the module that has it.
#pragma once

#include <filesystem>

#include "hw/sim/world/sdf/world_files.hpp"
#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {

/// The solids of an SDF file. `files`: all that it may refer to; nullptr: any. The module is loaded only for
/// a file that is XML and has the root of an SDF file: that takes 35 ms.
[[nodiscard]] SolidsOrError load_solids(const std::filesystem::path& sdf, const WorldFiles* files);

}  // namespace octoskin::sim
