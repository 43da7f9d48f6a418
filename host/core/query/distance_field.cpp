#include "host/core/query/distance_field.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/query/cube_geometry.hpp"
#include "host/core/query/nearest_search.hpp"

namespace octoskin {
namespace {

/// Half a voxel between neighbouring sample points of the axis. Half a diagonal each from a point to the
/// centre of its voxel, and from a voxel's centre to the nearest point of its cube.
constexpr double kVoxelsLost = 0.5 + 1.7320508075688773;

/// A word is a cube of four voxels along each edge. Two voxels of a row are adjacent in Morton order; the
/// next two follow eight further on.
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

BrickBox bricks_about(const MapConfig& map, const Eigen::AlignedBox3d& region) {
    assert(!region.isEmpty() && region.min().allFinite() && region.max().allFinite());
    return BrickBox::of({key_near(region.min(), map.resolution_m), key_near(region.max(), map.resolution_m)});
}

}  // namespace

DistanceField::DistanceField(const MapConfig& map, const FieldExtent& extent)
    : map_(map),
      reach_voxels_(voxels_of(map, extent.reach_m)),
      region_(bricks_about(map, extent.region)),
      occupied_(false, reach_voxels_, region_),
      not_free_(true, reach_voxels_, region_),
      sites_(not_free_.sites_box()) {}

std::size_t DistanceField::bricks_of(const MapConfig& map, const FieldExtent& extent) noexcept {
    return DistanceLayer::sites_box(bricks_about(map, extent.region), voxels_of(map, extent.reach_m))
        .bricks();
}

DistanceField::Update DistanceField::update(const FusedMap& now) {
    assert(now.resolution_m() == map_.resolution_m());
    Update update;
    // With a different threshold each brick may change.
    const bool is_judged_alike = now.config().log_odds_occupied == map_.config().log_odds_occupied;
    now.for_each_difference(map_, [&](const MapBrick& brick) { take(now, brick, update); });
    if (!is_judged_alike) {
        for (const MapBrick& brick : now.bricks()) take(now, brick, update);
    }
    map_ = now.copy();
    update.worked = occupied_.settle() + not_free_.settle();
    return update;
}

void DistanceField::take(const FusedMap& now, const MapBrick& brick, Update& update) {
    ++update.written;
    const BrickPlace place = BrickPlace::of(key_of_morton(brick.first));
    if (!sites_.box().holds(place)) return;
    const BrickSites sites = sites_of(now, brick.log_odds);
    const bool is_alike = brick.log_odds.values == nullptr;
    if (is_none(sites.occupied) && (is_alike || is_none(sites.unknown))) {
        sites_.take_away(sites_.index(place));
    } else {
        sites_.open(sites_.index(place), sites) = sites;
    }
    const bool is_changed = occupied_.set_sites(place, slices_of(sites.occupied));
    update.changed += (not_free_.set_sites(place, slices_of(both(sites))) || is_changed) ? 1U : 0U;
}

std::optional<double> DistanceField::distance_by(const DistanceLayer& layer, VoxelKey key) const noexcept {
    assert(region_.holds(BrickPlace::of(key)));
    const auto squared = layer.squared(key);
    if (!squared) return std::nullopt;
    return std::sqrt(static_cast<double>(*squared)) * map_.resolution_m();
}

std::optional<double> DistanceField::occupied_m(VoxelKey key) const noexcept {
    return distance_by(occupied_, key);
}

std::optional<double> DistanceField::not_free_m(VoxelKey key) const noexcept {
    return distance_by(not_free_, key);
}

bool DistanceField::tells_of(const PosedCapsule& capsule) const noexcept {
    const auto is_inside = [this](const Eigen::Vector3d& point) {
        const auto key = map_.key_of(point);
        return key && region_.holds(BrickPlace::of(*key));
    };
    return is_inside(capsule.p_a) && is_inside(capsule.p_b);
}

/// The field's distances at points of a segment, each valid for the part of the segment around the point.
class DistanceField::Samples {
  public:
    static constexpr std::size_t kMax = 256;

    /// False if the segment is too long or leaves the region.
    [[nodiscard]] bool take(const DistanceField& field, const PosedCapsule& capsule) {
        const double resolution_m = field.map_.resolution_m();
        const Eigen::Vector3d axis = capsule.p_b - capsule.p_a;
        const double length_m = axis.norm();
        const double steps = std::ceil(length_m / resolution_m);
        if (!(steps < static_cast<double>(kMax))) return false;
        const double half_step_m = steps > 0.0 ? 0.5 * length_m / steps : 0.0;
        for (double step = 0.0; step <= steps; ++step) {
            Sample& sample = samples_[count_++];
            sample.point = capsule.p_a + (steps > 0.0 ? step / steps : 0.0) * axis;
            const auto key = field.map_.key_of(sample.point);
            if (!key || !field.region_.holds(BrickPlace::of(*key))) return false;
            const double to_centre_m = (sample.point - field.map_.centre_of(*key)).norm();
            const auto look = [&](const DistanceLayer& layer, double& at_least_m, Bound& bound) {
                const auto squared = layer.squared(*key);
                const double found_m =
                    resolution_m * (squared ? std::sqrt(static_cast<double>(*squared)) : field.reach_voxels_);
                at_least_m = found_m - to_centre_m - half_step_m - kHalfDiagonal * resolution_m;
                // A cube is nearer than its centre by half its edge, or contains the point.
                const double at_most_m = std::max(0.0, found_m + to_centre_m - 0.5 * resolution_m);
                if (squared && !(bound.axis_m && *bound.axis_m <= at_most_m)) bound = {at_most_m, *key};
            };
            look(field.occupied_, sample.occupied_at_least_m, occupied_);
            look(field.not_free_, sample.not_free_at_least_m, not_free_);
        }
        half_step_m_ = half_step_m;
        return true;
    }

    /// Upper bound of the distance from the axis to a voxel of the kind: the voxel nearest to `at` is within
    /// it.
    struct Bound {
        std::optional<double> axis_m;  ///< empty: there is none within `axis_reach_m()`
        VoxelKey at{};
    };
    [[nodiscard]] const Bound& occupied() const { return occupied_; }
    [[nodiscard]] const Bound& not_free() const { return not_free_; }

    /// Box of the points with a voxel possibly within these limits of their parts; empty if there is none.
    [[nodiscard]] Eigen::AlignedBox3d box_within(double occupied_limit_m, double not_free_limit_m) const {
        Eigen::AlignedBox3d box;
        for (std::size_t i = 0; i < count_; ++i) {
            const Sample& sample = samples_[i];
            if (sample.occupied_at_least_m <= occupied_limit_m ||
                sample.not_free_at_least_m <= not_free_limit_m)
                box.extend(sample.point);
        }
        return box;
    }
    /// Half length of the part around each point.
    [[nodiscard]] double half_step_m() const { return half_step_m_; }

  private:
    static constexpr double kHalfDiagonal = 0.8660254037844387;
    struct Sample {
        Eigen::Vector3d point;
        double occupied_at_least_m;
        double not_free_at_least_m;
    };
    std::array<Sample, kMax> samples_;
    std::size_t count_ = 0;
    double half_step_m_ = 0.0;
    Bound occupied_;
    Bound not_free_;
};

Result<CapsuleClearance, CapsuleFault> DistanceField::clearance(const PosedCapsule& capsule) const noexcept {
    const double reach_m = std::max(0.0, axis_reach_m() - capsule.radius_m);
    return clearance(capsule, {reach_m, reach_m});
}

Result<CapsuleClearance, CapsuleFault> DistanceField::clearance(const PosedCapsule& capsule,
                                                                const ClearanceReach& reach) const noexcept {
    const auto is_within = [&](double reach_m) {
        return reach_m >= 0.0 && capsule.radius_m + reach_m <= axis_reach_m() + kDistanceStep_m;
    };
    Samples samples;
    if (fault_of(capsule) || !is_within(reach.occupied_m) || !is_within(reach.not_free_m) ||
        !samples.take(*this, capsule))
        return octoskin::clearance(map_, capsule, reach);
    const auto within = [&](const Samples::Bound& bound, double reach_m) {
        if (!bound.axis_m) return reach_m;
        return std::clamp(*bound.axis_m - capsule.radius_m + kDistanceStep_m, 0.0, reach_m);
    };
    const ClearanceReach nearer{within(samples.occupied(), reach.occupied_m),
                                within(samples.not_free(), reach.not_free_m)};
    NearestSearch search = clearance_search(map_, capsule, nearer);
    look_about(samples, search);
    return clearance_reported(search, map_, capsule, nearer);
}

void DistanceField::look_at_nearest(const std::optional<VoxelKey>& site, NearestSearch& search) const {
    if (!site) return;
    const Occupancy state = map_.occupancy(*site);
    state == Occupancy::occupied ? search.look_at_occupied({*site, 0}) : search.look_at_unknown({*site, 0});
}

/// Tests the certainly near voxels first, which reduces the rest of the search.
void DistanceField::look_about(const Samples& samples, NearestSearch& search) const {
    const auto may_be_near = [&] {
        return samples.box_within(search.occupied_limit_m() + kDistanceStep_m,
                                  search.unknown_limit_m() + kDistanceStep_m);
    };
    if (may_be_near().isEmpty()) return;
    if (samples.not_free().axis_m) look_at_nearest(not_free_.nearest(samples.not_free().at), search);
    if (samples.occupied().axis_m) look_at_nearest(occupied_.nearest(samples.occupied().at), search);
    Eigen::AlignedBox3d box = may_be_near();
    if (box.isEmpty()) return;
    const Eigen::Vector3d margin =
        Eigen::Vector3d::Constant(search.limit_m() + samples.half_step_m() + kDistanceStep_m);
    const BrickBox bricks = bricks_about(map_.config(), {box.min() - margin, box.max() + margin});
    for (int z = bricks.lowest.at[2]; z <= bricks.highest.at[2]; ++z) {
        for (int y = bricks.lowest.at[1]; y <= bricks.highest.at[1]; ++y) {
            for (int x = bricks.lowest.at[0]; x <= bricks.highest.at[0]; ++x) {
                const BrickPlace place{{x, y, z}};
                if (const BrickSites* const sites = sites_.find(place)) {
                    search.look_at(place.cube(), *sites);
                } else if (not_free_.is_plain(place)) {
                    search.look_at_unknown(place.cube());
                }
            }
        }
    }
}

double DistanceField::axis_reach_m() const noexcept {
    return std::max(0.0, reach_m() - (kVoxelsLost + 0.01) * map_.resolution_m());
}

}  // namespace octoskin
