// A world that includes models, as one that includes none.
#pragma once

#include <sdf/Root.hh>
#include <string>

namespace octoskin::sim {

/// The SDF of what was loaded, with each included model in the place of its <include>, and each mesh that
/// lies beside its file by its whole path; "model://..." stays. Elements that sdformat does not know are left
/// out. Empty if nothing is included. Changes the URIs of `root`.
[[nodiscard]] std::string written_out(sdf::Root& root);

}  // namespace octoskin::sim
