// Reads the cameras of a rig file.
#pragma once

#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/table.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {

/// `camera` or `cameras` of a rig; empty if it has neither. Throws Error: both, a key, a type, a range, a
/// lens for which a pixel has no ray or two rays, a link that is not at or below the base link, a name or a
/// device of two cameras.
[[nodiscard]] std::vector<Camera> read_cameras(const Table& top, const UrdfDocument& robot,
                                               const std::string& base_link);

}  // namespace octoskin::rig
