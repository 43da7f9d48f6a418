// Checks of an SDF file that do not need sdformat, and loading of the module that contains sdformat.
#pragma once

#include <filesystem>

#include "hw/mesh/allowed_files.hpp"
#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {

/// The solids of an SDF file. `files`: the files that it may refer to; nullptr: any. The module is loaded
/// only for an XML file with the root element of SDF: loading takes 35 ms.
[[nodiscard]] SolidsOrError load_solids(const std::filesystem::path& sdf, const AllowedFiles* files);

}  // namespace octoskin::sim
