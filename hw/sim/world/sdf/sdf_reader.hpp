// SDF to triangles, with sdformat.
#pragma once

#include <filesystem>

#include "hw/sim/world/sdf/sdf_module.hpp"

namespace octoskin::sim {

/// read_solids() of a file that is there and is SDF.
[[nodiscard]] SolidsOrError parse_solids(const std::filesystem::path& sdf);

}  // namespace octoskin::sim
