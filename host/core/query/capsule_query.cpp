#include "host/core/query/capsule_query.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/core/query/nearest_search.hpp"

namespace octoskin {
namespace {

constexpr double kLargest_m = 1e6;

std::optional<RefusedCapsule> refused_of(std::span<const PosedCapsule> capsules) {
    for (std::size_t i = 0; i < capsules.size(); ++i) {
        if (const auto fault = fault_of(capsules[i])) return RefusedCapsule{i, *fault};
    }
    return std::nullopt;
}

CapsuleAnswer search(const FusedMap& map, const PosedCapsule& capsule, SearchFor wanted) {
    const double reach_m = capsule.radius_m + kDistanceStep_m;
    NearestSearch search(map, {capsule.p_a, capsule.p_b, reach_m, reach_m, wanted});
    search.run();
    const auto occupied = search.occupied();
    const auto unknown = search.unknown();
    if (occupied.voxel) return {Occupancy::occupied, occupied.voxel, occupied.distance_m};
    if (unknown.voxel || search.is_outside()) return {Occupancy::unknown, unknown.voxel, unknown.distance_m};
    return {};
}

bool is_reach(double reach_m) {
    return reach_m >= 0.0 && reach_m <= kLargest_m;
}

/// Distance from the segment to the space outside the octree. One of the segment's ends is nearest to it.
double distance_to_bounds(const FusedMap& map, const PosedCapsule& capsule) {
    const double bound_m = kOriginKey * map.resolution_m();
    return std::max(0.0,
                    bound_m - std::max(capsule.p_a.cwiseAbs().maxCoeff(), capsule.p_b.cwiseAbs().maxCoeff()));
}

}  // namespace

std::optional<CapsuleFault> fault_of(const PosedCapsule& capsule) noexcept {
    if (!capsule.p_a.allFinite() || !capsule.p_b.allFinite() || !std::isfinite(capsule.radius_m))
        return CapsuleFault::not_finite;
    if (capsule.radius_m < 0.0) return CapsuleFault::negative_radius;
    const double largest =
        std::max({capsule.p_a.cwiseAbs().maxCoeff(), capsule.p_b.cwiseAbs().maxCoeff(), capsule.radius_m});
    if (largest > kLargest_m) return CapsuleFault::too_large;
    return std::nullopt;
}

Result<CapsuleAnswer, CapsuleFault> worst_in(const FusedMap& map, const PosedCapsule& capsule) noexcept {
    if (const auto fault = fault_of(capsule)) return unexpected(*fault);
    return search(map, capsule, SearchFor::worst);
}

Status<RefusedCapsule> worst_in(const FusedMap& map, std::span<const PosedCapsule> capsules,
                                std::span<CapsuleAnswer> answers) noexcept {
    assert(answers.size() == capsules.size());
    if (const auto refused = refused_of(capsules)) return unexpected(*refused);
    for (std::size_t i = 0; i < capsules.size(); ++i) answers[i] = search(map, capsules[i], SearchFor::worst);
    return Done{};
}

Result<bool, RefusedCapsule> is_free(const FusedMap& map, std::span<const PosedCapsule> capsules) noexcept {
    if (const auto refused = refused_of(capsules)) return unexpected(*refused);
    for (const PosedCapsule& capsule : capsules) {
        if (search(map, capsule, SearchFor::any).state != Occupancy::free) return false;
    }
    return true;
}

NearestSearch clearance_search(const FusedMap& map, const PosedCapsule& capsule,
                               const ClearanceReach& reach) noexcept {
    const double radius_m = capsule.radius_m + kDistanceStep_m;
    return {map,
            {capsule.p_a, capsule.p_b, radius_m + reach.occupied_m, radius_m + reach.not_free_m,
             SearchFor::both}};
}

CapsuleClearance clearance_reported(const NearestSearch& search, const FusedMap& map,
                                    const PosedCapsule& capsule, const ClearanceReach& reach) noexcept {
    const double radius_m = capsule.radius_m + kDistanceStep_m;
    const auto from_surface = [&](double distance_m) { return std::max(0.0, distance_m - capsule.radius_m); };
    CapsuleClearance clearance;
    const auto take_not_free = [&](double distance_m) {
        if (distance_m > radius_m + reach.not_free_m) return;
        const double gap_m = from_surface(distance_m);
        if (!clearance.not_free_m || gap_m < *clearance.not_free_m) clearance.not_free_m = gap_m;
    };
    if (const auto found = search.occupied(); found.voxel) {
        clearance.occupied_m = from_surface(found.distance_m);
        take_not_free(found.distance_m);
    }
    if (const auto found = search.unknown(); found.voxel) take_not_free(found.distance_m);
    if (search.is_outside()) take_not_free(distance_to_bounds(map, capsule));
    return clearance;
}

Result<CapsuleClearance, CapsuleFault> clearance(const FusedMap& map, const PosedCapsule& capsule,
                                                 const ClearanceReach& reach) noexcept {
    if (const auto fault = fault_of(capsule)) return unexpected(*fault);
    if (!is_reach(reach.occupied_m) || !is_reach(reach.not_free_m))
        return unexpected(CapsuleFault::too_large);
    // Near voxels are found in a small space: the first step is usually the last.
    constexpr double kVoxelsFirst = 2.0;
    CapsuleClearance found;
    for (double step_m = kVoxelsFirst * map.resolution_m();; step_m *= 2.0) {
        // A distance that is already known is not searched for again.
        const auto within = [&](const std::optional<double>& found_m, double reach_m) {
            return found_m.value_or(std::min(step_m, reach_m));
        };
        const ClearanceReach next{within(found.occupied_m, reach.occupied_m),
                                  within(found.not_free_m, reach.not_free_m)};
        NearestSearch search = clearance_search(map, capsule, next);
        search.run();
        found = clearance_reported(search, map, capsule, next);
        const bool has_occupied = found.occupied_m || !(step_m < reach.occupied_m);
        const bool has_not_free = found.not_free_m || !(step_m < reach.not_free_m);
        if (has_occupied && has_not_free) return found;
    }
}

}  // namespace octoskin
