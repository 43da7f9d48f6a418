// The output of octoskin-world-read: solids and warnings, or the error of the file.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "hw/sim/world/solid.hpp"

namespace octoskin::sim {

struct SolidsOfFile {
    std::vector<Solid> solids;
    std::vector<std::string> warnings = {};  ///< skipped elements, without the file's name
    /// The same SDF with its includes expanded and absolute paths of meshes; empty: it includes nothing.
    std::string written_out = {};
    /// The uris of the meshes that were read as shapes, as in `written_out`, or else as in the file.
    std::vector<std::string> meshes = {};
};

using SolidsOrError = Result<SolidsOfFile, Error>;

/// Both ends are of one build on one machine: numbers are written as in memory, bit for bit.
[[nodiscard]] std::string to_bytes(const SolidsOrError& solids);

/// Reads these bytes. Empty unless they are complete, nothing follows them, and each corner of a triangle is
/// one of its solid's vertices. The file of an Error is empty: the caller knows it.
[[nodiscard]] std::optional<SolidsOrError> from_bytes(std::string_view bytes);

}  // namespace octoskin::sim
