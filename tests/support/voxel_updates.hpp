// The terms of an image one by one, for tests that look at each.
#pragma once

#include <algorithm>
#include <vector>

#include "host/core/mapping/depth_terms.hpp"

namespace octoskin {

/// In Morton order.
inline std::vector<VoxelUpdate> updates_of(const DepthTerms& terms) {
    std::vector<VoxelUpdate> updates;
    terms.for_each([&](const VoxelUpdate& update) { updates.push_back(update); });
    std::ranges::sort(updates, {}, [](const VoxelUpdate& update) { return morton_of(update.key); });
    return updates;
}

}  // namespace octoskin
