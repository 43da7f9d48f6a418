// SDF to triangles, with sdformat.
#pragma once

#include "hw/sim/world/sdf/sdf_module.hpp"

namespace octoskin::sim {

/// read_solids() of a file that is there and is SDF, in this process.
[[nodiscard]] SolidsOrError parse_solids(const SdfInput& sdf);

}  // namespace octoskin::sim
