// The load of a rig's CAN bus.
#pragma once

#include "hw/rigfile/rig.hpp"

namespace octoskin::rig {

/// Share of the bus time used by all periodic frames of the rig, with worst-case stuffing and one reading per
/// frame; 1.0 is a full bus.
[[nodiscard]] double can_load(const Rig& rig);

}  // namespace octoskin::rig
