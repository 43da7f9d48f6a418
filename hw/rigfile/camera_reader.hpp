// From a rig file to its camera.
#pragma once

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// Nothing of a rig is further from its base than this.
inline constexpr double kRoomReachM = 100.0;

/// `camera` of a rig. Throws Fault: a key, a type, a range, or a lens for which a pixel has no ray or two.
[[nodiscard]] Camera read_camera(const Value& value);

}  // namespace octoskin::rig
