// Reads the solids of an SDF file.
#pragma once

#include <filesystem>
#include <vector>

#include "common/result.hpp"
#include "hw/sim/world/solid.hpp"
#include "hw/sim/world/world_error.hpp"

namespace octoskin::sim {

/// Every visual of every model, nested ones included, in file order, in world coordinates (metres). The file
/// holds a world or one model. Shapes: box, cylinder, sphere, capsule, ellipsoid, plane, mesh (path relative
/// to the file). Errors: whatever sdformat finds, elements it does not know included; any other shape; a mesh
/// that cannot be read; a size that is not positive and finite; no visual at all; sdformat cannot be loaded.
[[nodiscard]] Result<std::vector<Solid>, WorldError> read_solids(const std::filesystem::path& sdf);

}  // namespace octoskin::sim
