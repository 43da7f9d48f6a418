// Reads the camera of a rig file.
#pragma once

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {

/// `camera` of a rig. Throws Error: a key, a type, a range, a lens for which a pixel has no ray or two rays,
/// or a link that is not at or below the base link.
[[nodiscard]] Camera read_camera(const Value& value, const UrdfDocument& robot, const std::string& base_link);

}  // namespace octoskin::rig
