// How busy a rig keeps its CAN bus.
#pragma once

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// Share of the bus's time that everything the rig sends regularly takes, worst-case stuffing, one reading
/// per frame: 1.0 is a full bus.
[[nodiscard]] double can_load(const Rig& rig);

}  // namespace octoskin::rig
