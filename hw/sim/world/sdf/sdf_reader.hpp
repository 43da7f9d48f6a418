// SDF to triangles, with sdformat.
#pragma once

#include "hw/sim/world/sdf/sdf_module.hpp"

namespace octoskin::sim {

/// read_solids() in this process, for an existing SDF file.
[[nodiscard]] SolidsOrError parse_solids(const SdfInput& sdf);

}  // namespace octoskin::sim
