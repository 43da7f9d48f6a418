#include "host/apps/query/kept_field.hpp"

#include <algorithm>
#include <new>

namespace octoskin {
namespace {

/// Time per changed brick to update the field, and time saved per posture: measured at 0.04 and 0.02 m.
/// Approximate values suffice: they decide when a field is made, not what is answered.
constexpr std::size_t kBrick_us = 5;
constexpr std::size_t kPosture_us = 100;

/// Margin beyond the capsules' surfaces for the field's loss by its voxels: see axis_reach_m().
constexpr double kVoxelsLost = 2.25;
/// The next path seldom covers exactly the same space.
constexpr double kWider_m = 0.1;

FieldExtent extent_of(const MapConfig& map, const AskedSpace& asked) {
    return {asked.axes, asked.reach_m + asked.radius_max_m + kVoxelsLost * map.resolution_m};
}

bool is_possible(const MapConfig& map, const FieldExtent& extent) {
    return extent.reach_m <= DistanceLayer::kReachMax * map.resolution_m &&
           DistanceField::bricks_of(map, extent) <= KeptField::kBricksMax;
}

std::size_t bricks_written(const FusedMap& map, const FusedMap& since) {
    std::size_t bricks = 0;
    map.for_each_difference(since, [&](const MapBrick&) { ++bricks; });
    return bricks;
}

}  // namespace

const DistanceField* KeptField::of(const FusedMap& map, const AskedSpace& asked) {
    const MapConfig& config = map.config();
    const auto pays = [&](const FusedMap& since) {
        return bricks_written(map, since) * kBrick_us <= asked.postures * kPosture_us;
    };
    try {
        if (!tells(config, asked)) {
            if (asked.postures < kPosturesMin || !pays(FusedMap(config)) || !make(config, asked))
                return nullptr;
        } else if (!pays(field_->map())) {
            return nullptr;
        }
        (void)field_->update(map);
        return &*field_;
    } catch (const std::bad_alloc&) {  // answered by search instead
        drop();
        return nullptr;
    }
}

bool KeptField::tells(const MapConfig& map, const AskedSpace& asked) const {
    if (!field_ || field_->map().resolution_m() != map.resolution_m) return false;
    return extent_.region.contains(asked.axes) && extent_of(map, asked).reach_m <= extent_.reach_m;
}

/// The extent includes that of the previous field, so that alternating queries share one field.
bool KeptField::make(const MapConfig& map, const AskedSpace& asked) {
    FieldExtent alone = extent_of(map, asked);
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kWider_m);
    FieldExtent both = alone;
    both.region = {asked.axes.min() - margin, asked.axes.max() + margin};
    if (field_) {
        both.region.extend(extent_.region);
        both.reach_m = std::max(both.reach_m, extent_.reach_m);
    }
    const FieldExtent& extent = is_possible(map, both) ? both : alone;
    if (!is_possible(map, extent)) return false;
    drop();  // frees it before a second one is allocated
    extent_ = extent;
    field_.emplace(map, extent_);
    return true;
}

}  // namespace octoskin
