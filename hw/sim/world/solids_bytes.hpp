// What octoskin-world-read hands to the program that started it: solids and warnings, or what is wrong with
// the file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "hw/sim/world/solid.hpp"
#include "hw/sim/world/world_error.hpp"

namespace octoskin::sim {

struct SolidsOfFile {
    std::vector<Solid> solids;
    std::vector<std::string> warnings = {};  ///< what was passed over, without the file's name
    /// The same SDF with what it includes in it, and meshes by their whole paths; empty: it includes nothing.
    std::string written_out = {};
    /// The uris of the meshes that were read as shapes, as `written_out` or else the file has them.
    std::vector<std::string> meshes = {};
};

using SolidsOrError = Result<SolidsOfFile, WorldError>;

/// Both ends are of one build and one machine: numbers as they lie in memory, every bit kept.
[[nodiscard]] std::string to_bytes(const SolidsOrError& solids);

/// The same again. Empty unless the bytes are whole, nothing follows them, and each corner of a triangle is
/// one of its solid's vertices. The error's file is empty: the caller knows it.
[[nodiscard]] std::optional<SolidsOrError> from_bytes(std::string_view bytes);

}  // namespace octoskin::sim
