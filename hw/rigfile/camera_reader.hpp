// Reads the camera of a rig file.
#pragma once

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// `camera` of a rig. Throws Error: a key, a type, a range, or a lens for which a pixel has no ray or two
/// rays.
[[nodiscard]] Camera read_camera(const Value& value);

}  // namespace octoskin::rig
