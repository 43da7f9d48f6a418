#include "host/core/query/distance_field.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/query/nearest_search.hpp"

namespace octoskin {
namespace {

/// From a point of the axis to the next that is looked at, half a voxel; from there to the centre of its
/// voxel, half a diagonal at most, as from a voxel's centre to the nearest point of its cube.
constexpr double kVoxelsLost = 0.5 + 1.7320508075688773;

/// A word is a cube of four voxels along each edge; two voxels of a row lie side by side in Morton order, and
/// the next two of it eight further on.
void add_word(std::uint64_t voxels, unsigned word, SiteSlices& slices) {
    const auto row_at = [voxels](unsigned first) {
        return (voxels >> first & 3U) | (voxels >> (first + 8U) & 3U) << 2U;
    };
    const unsigned corner = 4 * (word & 1U) + 8 * 4 * (word >> 1U & 1U);
    for (unsigned z = 0; z < 4; ++z) {
        const unsigned first = 4 * (z & 1U) + 32 * (z >> 1U);
        const std::uint64_t rows =
            row_at(first) | row_at(first + 2) << 8U | row_at(first + 16) << 16U | row_at(first + 18) << 24U;
        slices.at(z + 4 * (word >> 2U & 1U)) |= rows << corner;
    }
}

SiteSlices slices_of(const BrickMask& voxels) {
    SiteSlices slices{};
    for (unsigned word = 0; word < voxels.size(); ++word) add_word(voxels.at(word), word, slices);
    return slices;
}

BrickSites sites_of(const FusedMap& map, const BrickView& brick) {
    constexpr std::uint64_t kAll = ~std::uint64_t{0};
    BrickSites sites;
    if (brick.values == nullptr) {
        const Occupancy all = brick.is_unknown() ? Occupancy::unknown : map.occupancy_of(brick.value);
        sites.occupied.fill(all == Occupancy::occupied ? kAll : 0);
        sites.unknown.fill(all == Occupancy::unknown ? kAll : 0);
        return sites;
    }
    for (std::size_t word = 0; word < kBrickVoxels / 64; ++word) {
        const WordSets sets = sets_of(*brick.values, word, map.config().log_odds_occupied);
        sites.occupied.at(word) = sets.at_least;
        sites.unknown.at(word) = ~sets.known;
    }
    return sites;
}

BrickMask both(const BrickSites& sites) {
    BrickMask mask = sites.occupied;
    for (std::size_t word = 0; word < mask.size(); ++word) mask.at(word) |= sites.unknown.at(word);
    return mask;
}

bool is_none(const BrickMask& voxels) {
    return std::ranges::all_of(voxels, [](std::uint64_t word) { return word == 0; });
}

int voxels_of(const MapConfig& map, double reach_m) {
    assert(reach_m > 0.0 && reach_m <= DistanceLayer::kReachMax * map.resolution_m);
    return std::clamp(static_cast<int>(std::ceil(reach_m / map.resolution_m - 1e-9)), 1,
                      DistanceLayer::kReachMax);
}

}  // namespace

DistanceField::DistanceField(const MapConfig& map, double reach_m)
    : reach_voxels_(voxels_of(map, reach_m)),
      map_(map),
      occupied_(false, reach_voxels_),
      not_free_(true, reach_voxels_) {}

DistanceField::Update DistanceField::update(const FusedMap& now) {
    assert(now.resolution_m() == map_.resolution_m());
    Update update;
    const auto take = [&](const MapBrick& brick) {
        ++update.written;
        const BrickSites sites = sites_of(now, brick.log_odds);
        const bool is_alike = brick.log_odds.values == nullptr;
        if (is_none(sites.occupied) && (is_alike || is_none(sites.unknown))) {
            sites_.erase(brick.first);
        } else {
            sites_[brick.first] = sites;
        }
        const bool is_changed = occupied_.set_sites(brick.first, slices_of(sites.occupied));
        update.changed += (not_free_.set_sites(brick.first, slices_of(both(sites))) || is_changed) ? 1U : 0U;
    };
    // With another threshold every brick may be another one.
    const bool is_judged_alike = now.config().log_odds_occupied == map_.config().log_odds_occupied;
    now.for_each_difference(map_, take);
    if (!is_judged_alike) {
        for (const MapBrick& brick : now.bricks()) take(brick);
    }
    map_ = now.copy();
    update.worked = occupied_.settle() + not_free_.settle();
    return update;
}

std::optional<double> DistanceField::occupied_m(VoxelKey key) const noexcept {
    const auto squared = occupied_.squared(key);
    if (!squared) return std::nullopt;
    return std::sqrt(static_cast<double>(*squared)) * map_.resolution_m();
}

std::optional<double> DistanceField::not_free_m(VoxelKey key) const noexcept {
    const auto squared = not_free_.squared(key);
    if (!squared) return std::nullopt;
    return std::sqrt(static_cast<double>(*squared)) * map_.resolution_m();
}

Result<CapsuleClearance, CapsuleFault> DistanceField::clearance(const PosedCapsule& capsule) const noexcept {
    const double beyond_m = axis_reach_m() - capsule.radius_m;
    const auto bounds = beyond_m > 0.0 ? bounds_along(capsule) : std::nullopt;
    if (!bounds) return octoskin::clearance(map_, capsule, std::max(0.0, beyond_m));
    const auto reach_of = [&](double bound_m) {
        return std::clamp(bound_m - capsule.radius_m, 0.0, beyond_m);
    };
    // Of what is nowhere near the axis nothing is found, however far is looked.
    const double not_free_m = reach_of(bounds->not_free_m.value_or(0.0));
    const double occupied_m = bounds->occupied_m ? reach_of(*bounds->occupied_m) : not_free_m;
    return clearance_within(map_, capsule, {occupied_m, not_free_m}, &sites_);
}

/// No voxel of the kind need be looked for further from the axis. Empty: the field does not tell.
std::optional<DistanceField::Bounds> DistanceField::bounds_along(const PosedCapsule& capsule) const noexcept {
    const Eigen::Vector3d axis = capsule.p_b - capsule.p_a;
    const double steps = std::ceil(axis.norm() / map_.resolution_m());
    constexpr double kStepsMax = 1000.0;  // a longer one is searched as it is
    if (!(steps <= kStepsMax)) return std::nullopt;
    Bounds bounds;
    for (double step = 0.0; step <= steps; ++step) {
        const Eigen::Vector3d point = capsule.p_a + (steps > 0.0 ? step / steps : 0.0) * axis;
        const auto key = map_.key_of(point);
        if (!key) return std::nullopt;
        const double to_centre_m = (point - map_.centre_of(*key)).norm() + kDistanceStep_m;
        const auto take = [&](std::optional<double>& bound_m, const std::optional<double>& found_m) {
            if (found_m && !(bound_m && *bound_m <= *found_m + to_centre_m)) bound_m = *found_m + to_centre_m;
        };
        take(bounds.occupied_m, occupied_m(*key));
        take(bounds.not_free_m, not_free_m(*key));
    }
    return bounds;
}

double DistanceField::axis_reach_m() const noexcept {
    return std::max(0.0, reach_m() - (kVoxelsLost + 0.01) * map_.resolution_m());
}

}  // namespace octoskin
