// The module that is loaded at run time to read an SDF file: the only binary linked with sdformat and assimp.
#pragma once

#include <filesystem>

#include "hw/mesh/allowed_files.hpp"
#include "hw/sim/world/solids_bytes.hpp"

namespace octoskin::sim {

struct SdfInput {
    std::filesystem::path file;           ///< its name: mesh paths are relative to it
    std::filesystem::path path;           ///< the path for opening it
    const AllowedFiles* files = nullptr;  ///< the files it may refer to; nullptr: any
};

/// The module's file name; it is in the loader's search path of the running program.
inline constexpr const char* kSdfModule = "octoskin-sdf.so";
/// The module's one symbol, and its type. Module and program are of one build, so that they can exchange C++
/// objects.
inline constexpr const char* kReadSolidsSymbol = "octoskin_read_solids_v5";
using ReadSolids = void (*)(const SdfInput& sdf, SolidsOrError* result);

}  // namespace octoskin::sim
