// The pictures of the report: the scene, and the three maps of one seed, from both sides.
#pragma once

#include <vector>

#include "host/core/pipeline/fed_map.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/report/report.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin {

/// Scene first, then depth, proximity and fused; for a rig without a camera only the scene and proximity.
/// About 10 s on one core.
[[nodiscard]] std::vector<report::PicturePair> draw_pictures(const sim::World& world,
                                                             const sim::Scenario& scenario,
                                                             const rig::Rig& rig,
                                                             std::span<const FedMap> maps,
                                                             const evaluation::Truth& truth);

/// The same maps as bricks, for the view in three dimensions. O(voxels).
[[nodiscard]] std::vector<report::ViewedMap> viewed_maps(std::span<const FedMap> maps, std::size_t cameras);

}  // namespace octoskin
