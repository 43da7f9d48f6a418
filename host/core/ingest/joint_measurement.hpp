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
    /// Relock count of the host's clock (HostClockEstimate) at this time. The distance of two times with
    /// different counts is not reliable.
    std::uint64_t relocks = 0;
};

}  // namespace octoskin
