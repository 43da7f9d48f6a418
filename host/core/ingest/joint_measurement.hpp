// One joint sample in host time.
#pragma once

#include <array>
#include <cstdint>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

/// A sample of one source of the rig.
struct JointMeasurement {
    HostTime sampled;
    std::array<double, wire::kJointsPerSample> position_rad{};
    /// Relock count of the host's clock (HostClockEstimate) at this time. The distance of two times with
    /// different counts is not reliable.
    std::uint64_t relocks = 0;
    std::uint8_t source = 0;  ///< index in HostRig::joint_sources
};

}  // namespace octoskin
