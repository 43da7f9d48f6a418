// What is loaded at run time to read an SDF file: the only binary that is linked with sdformat and assimp.
#pragma once

#include <filesystem>

#include "hw/sim/world/sdf/world_files.hpp"
#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {

struct SdfInput {
    std::filesystem::path file;         ///< as it was named: meshes lie beside it
    std::filesystem::path path;         ///< to open it by
    const WorldFiles* files = nullptr;  ///< what it may refer to; nullptr: anything
};

/// The module's file name; it lies where the loader looks for libraries of the running program.
inline constexpr const char* kSdfModule = "octoskin-sdf.so";
/// The module's one symbol, and its type. Module and program are of one build, so that they may hand each
/// other C++ objects.
inline constexpr const char* kReadSolidsSymbol = "octoskin_read_solids_v5";
using ReadSolids = void (*)(const SdfInput& sdf, SolidsOrError* result);

}  // namespace octoskin::sim
