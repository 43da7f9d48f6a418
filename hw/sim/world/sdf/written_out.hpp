// Expands the included models of a world.
#pragma once

#include <sdf/Root.hh>
#include <string>

namespace octoskin::sim {

/// The SDF of the loaded world. Each <include> is replaced by its model, and each relative path of a mesh by
/// its absolute path; "model://..." stays. Elements that sdformat does not know are left out. Empty if the
/// world has no <include>. Changes the URIs of `root`.
[[nodiscard]] std::string written_out(sdf::Root& root);

}  // namespace octoskin::sim
