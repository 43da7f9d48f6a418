#include "host/apps/evaluation/unknown_space.hpp"

#include <cmath>
#include <limits>

namespace octoskin::evaluation {
namespace {

constexpr Nanoseconds kEvery{250'000'000};
constexpr double kPocketMin_m3 = 1e-3;  // a litre: what is smaller no planner misses

double voxel_m3(const FusedMap& map) {
    return std::pow(map.resolution_m(), 3);
}

/// No pocket is looked for, which would take longer.
std::optional<UnknownPockets> count_unknown(const FusedMap& map, const PocketRegion& region) {
    return UnknownPockets::find(map, region, std::numeric_limits<std::size_t>::max());
}

}  // namespace

void UnknownSpaceMeter::see(HostTime captured, const FusedMap* depth, const FusedMap& fused) {
    if (!begin_) begin_ = next_ = last_ = captured;
    if (captured > last_) last_ = captured;
    if (captured < next_) return;
    sample(captured, depth, fused);
    next_ = captured + kEvery;
}

void UnknownSpaceMeter::sample(HostTime captured, const FusedMap* depth, const FusedMap& fused) {
    const auto of_fused = count_unknown(fused, space_.region);
    if (!of_fused) return;
    space_.region_m3 = static_cast<double>(of_fused->region_voxels()) * voxel_m3(fused);
    UnknownSample sample;
    sample.t_s = std::chrono::duration<double>(captured - *begin_).count();
    sample.fused_m3 = static_cast<double>(of_fused->unknown_voxels()) * voxel_m3(fused);
    if (depth != nullptr) {
        if (const auto of_depth = count_unknown(*depth, space_.region))
            sample.depth_m3 = static_cast<double>(of_depth->unknown_voxels()) * voxel_m3(*depth);
    }
    space_.samples.push_back(sample);
}

UnknownSpace UnknownSpaceMeter::finish(const FusedMap* depth, const FusedMap& fused) {
    if (begin_) sample(last_, depth, fused);
    const auto voxels_min = static_cast<std::size_t>(std::ceil(kPocketMin_m3 / voxel_m3(fused)));
    if (const auto found = UnknownPockets::find(fused, space_.region, voxels_min))
        space_.pockets = found->pockets();
    return std::move(space_);
}

}  // namespace octoskin::evaluation
