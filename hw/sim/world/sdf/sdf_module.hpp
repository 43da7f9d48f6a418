// What is loaded at run time to read an SDF file: the only binary that is linked with sdformat and assimp.
#pragma once

#include <filesystem>
#include <vector>

#include "common/result.hpp"
#include "hw/sim/world/solid.hpp"
#include "hw/sim/world/world_error.hpp"

namespace octoskin::sim {

using SolidsOrError = Result<std::vector<Solid>, WorldError>;

/// The module's file name; it lies where the loader looks for libraries of the running program.
inline constexpr const char* kSdfModule = "octoskin-sdf.so";
/// The module's one symbol, and its type. Module and program are of one build, so that they may hand each
/// other C++ objects.
inline constexpr const char* kReadSolidsSymbol = "octoskin_read_solids_v1";
using ReadSolids = void (*)(const std::filesystem::path& sdf, SolidsOrError* result);

}  // namespace octoskin::sim
