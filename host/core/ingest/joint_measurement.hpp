// One joint sample in host time.
#pragma once

#include <array>
#include <cstdint>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

struct JointMeasurement {
    HostTime sampled;
    std::array<double, wire::kJointsPerSample> position_rad{};
    /// Of the host's clock (HostClockEstimate), when this time was told: two times that differ in it may be
    /// further apart, or less far, than they say.
    std::uint64_t relocks = 0;
};

}  // namespace octoskin
