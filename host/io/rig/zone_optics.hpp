// What a zone of a sensor sees of the cone that the rig gives it.
#pragma once

#include "common/config/node_config.hpp"
#include "host/core/rig/beam_optics.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The cone as a zone sees it; an ideal ray if the sensor has none. The whole array sees all of it. A smaller
/// zone sees its own SPADs' part, blurred by the lens: to where the blur has all but ended, and about as a
/// Gaussian of the same variance.
[[nodiscard]] BeamOptics beam_optics(const rig::Sensor& sensor, const Roi& zone);

}  // namespace octoskin
