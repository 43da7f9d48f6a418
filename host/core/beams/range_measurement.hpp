// One accepted reading in host time. It has no place in the map yet.
#pragma once

#include <optional>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"

namespace octoskin {

struct RangeMeasurement {
    BeamSource source;
    HostTime captured;              ///< middle of the ranging window
    std::optional<double> range_m;  ///< along the zone's direction, offset added; empty: no target
    double sigma_m = 0.0;
};

}  // namespace octoskin
