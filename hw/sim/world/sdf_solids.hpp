// Reads the solids of an SDF file.
#pragma once

#include "host/io/folder/file_place.hpp"
#include "hw/sim/world/reader_process.hpp"
#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {

/// Every visual of every model, nested ones included, in file order, in world coordinates (metres). The file
/// holds a world or one model. Shapes: box, cylinder, sphere, capsule, ellipsoid, plane, mesh (path relative
/// to the file, or "model://..." as model_folders.hpp says). Warnings, each with the file's name: elements
/// that sdformat does not know, inertias that it does not like. Errors: whatever else sdformat finds; any
/// other shape; a mesh that cannot be read; a size that is not positive and finite; no visual at all; a limit
/// that is reached.
///
/// Read in a process of its own (some 50 ms), which may take what `limits` say. A file below a folder that
/// was named, a recording, refers to files of that folder alone.
[[nodiscard]] SolidsOrError read_solids(const FilePlace& sdf, const ReadLimits& limits = {});

}  // namespace octoskin::sim
