// What the experiment's arm and its sensor boards put onto the bus: real node cores, one virtual clock.
#pragma once

#include <cstdint>
#include <vector>

#include "host/core/pipeline/can_source.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::test {

/// 2 s at rest, then one revolution in 10 s, seen by the rig's range sensors; without its camera. Takes 2 s.
[[nodiscard]] std::vector<StampedFrame> experiment_log(rig::Rig rig, std::uint64_t seed);

}  // namespace octoskin::test
