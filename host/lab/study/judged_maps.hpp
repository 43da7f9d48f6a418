// The maps of a replayed recording against the ground truth.
#pragma once

#include <cstdint>
#include <vector>

#include "host/apps/playback/playback.hpp"
#include "host/apps/profile/named_mapping.hpp"
#include "host/lab/evaluation/aggregate.hpp"
#include "host/lab/evaluation/truth.hpp"

namespace octoskin {

/// One run for each map of the playback; without a camera there is only the map of the ranges. The map of
/// both is compared with the camera's own. About 0.1 s a map for the experiment.
[[nodiscard]] std::vector<evaluation::Run> judge_maps(const Playback& playback,
                                                      const NamedMapping& configuration, std::uint64_t seed,
                                                      const evaluation::Truth& truth);

}  // namespace octoskin
