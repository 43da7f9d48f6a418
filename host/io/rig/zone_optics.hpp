// The part of a sensor's cone that a zone sees.
#pragma once

#include "common/config/node_config.hpp"
#include "host/core/rig/beam_optics.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The cone of a zone; an ideal ray if the rig gives the sensor no cone. The whole array sees all of the
/// cone. A smaller zone sees the part of its own SPADs, blurred by the lens: up to where the blur nearly
/// ends, and approximately as a Gaussian of the same variance.
[[nodiscard]] BeamOptics beam_optics(const rig::Sensor& sensor, const Roi& zone);

}  // namespace octoskin
