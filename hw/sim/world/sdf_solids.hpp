// Reads the solids of an SDF file.
#pragma once

#include "host/io/folder/file_place.hpp"
#include "hw/sim/world/reader_process.hpp"
#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {

/// Every visual of every model, nested ones included, in file order, in world coordinates (metres). The file
/// holds a world or one model. Shapes: box, cylinder, sphere, capsule, ellipsoid, plane, mesh (path relative
/// to the file, or "model://..." as model_folders.hpp says). Warnings, each with the file's name: elements
/// that sdformat does not know, invalid inertias. Errors: all other errors of sdformat; any other shape; a
/// mesh that cannot be read; a size that is not positive and finite; no visual at all; a limit of `limits` is
/// reached.
///
/// Read in a separate process (about 50 ms) within `limits`. A file below a named folder (a recording) may
/// refer only to files of that folder.
[[nodiscard]] SolidsOrError read_solids(const FilePlace& sdf, const ReadLimits& limits = {});

}  // namespace octoskin::sim
