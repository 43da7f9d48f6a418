// The CAN log of the experiment's arm and its sensor boards: real node cores on one virtual clock.
#pragma once

#include <cstdint>
#include <vector>

#include "host/core/pipeline/can_source.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::test {

/// 2 s at rest, then revolutions of 10 s each, seen by the rig's range sensors; without its camera. The
/// flange ends where it begins, the first joint 0.4 rad from there. Takes 2 s for each revolution.
[[nodiscard]] std::vector<StampedFrame> experiment_log(rig::Rig rig, std::uint64_t seed,
                                                       std::uint32_t revolutions = 1);

}  // namespace octoskin::test
