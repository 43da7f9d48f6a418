#include "host/core/pipeline/oversized_cone.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "host/core/mapping/cone_size.hpp"

namespace octoskin {
namespace {

/// The longest readings of each kind that a zone can give; any shorter one has fewer voxels. Beyond
/// `hit_range_max_m` a reading marks nothing, so the longest marking one is listed separately.
std::array<Beam, 3> largest_beams(const HostRig& rig, const HostZone& zone, const MappingConfig& mapping) {
    Beam longest;
    longest.optics = zone.optics;
    longest.range_m = rig.range_limits.max_m;
    longest.sigma_m = rig.range_limits.sigma_max_m;
    Beam marking = longest;
    marking.range_m = std::min(rig.range_limits.max_m, mapping.cone_of(zone.optics).hit_range_max_m);
    Beam without_return;
    without_return.optics = zone.optics;
    without_return.clear_limit_m = std::numeric_limits<double>::infinity();
    return {longest, marking, without_return};
}

double round_up_to_two_digits(double value) {
    const double step = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return std::ceil(value / step) * step;
}

double resolution_min_m(const Beam& beam, MappingConfig mapping) {
    double& resolution_m = mapping.map.resolution_m;
    resolution_m *= std::cbrt(cone_voxels_at_most(beam, mapping) / kConeVoxelsMax);
    resolution_m = round_up_to_two_digits(resolution_m);
    // Margins are a number of voxels, and therefore wider with larger voxels.
    constexpr double kMore = 1.02;
    while (is_cone_too_large(beam, mapping)) resolution_m = round_up_to_two_digits(resolution_m * kMore);
    return resolution_m;
}

/// The larger of the largest cone so far and the cone of this reading.
std::optional<OversizedCone> larger(std::optional<OversizedCone> largest, const Beam& beam,
                                    const MappingConfig& mapping, std::size_t node, std::size_t sensor) {
    const double voxels = cone_voxels_at_most(beam, mapping);
    if (!is_cone_too_large(beam, mapping) || (largest && voxels <= largest->voxels)) return largest;
    return OversizedCone{.node = node,
                         .sensor = sensor,
                         .optics = beam.optics,
                         .has_range = beam.range_m.has_value(),
                         .length_m = cone_length_m(beam, mapping),
                         .voxels = voxels,
                         .resolution_min_m = resolution_min_m(beam, mapping)};
}

}  // namespace

std::optional<OversizedCone> find_oversized_cone(const HostRig& rig, const MappingConfig& mapping) {
    std::optional<OversizedCone> largest;
    if (mapping.range_update != RangeUpdate::cone) return largest;
    for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
        for (std::size_t s = 0; s < rig.nodes[n].sensors.size(); ++s) {
            for (const HostZone& zone : rig.nodes[n].sensors[s].zones) {
                if (!zone.optics.is_cone()) continue;
                for (const Beam& beam : largest_beams(rig, zone, mapping))
                    largest = larger(largest, beam, mapping, n, s);
            }
        }
    }
    return largest;
}

}  // namespace octoskin
