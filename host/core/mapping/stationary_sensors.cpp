#include "host/core/mapping/stationary_sensors.hpp"

#include <functional>

#include "host/core/mapping/cone_evidence.hpp"

namespace octoskin {

void StationarySensors::conclude(const Beam& beam, const ConfirmedRanges::Answer& answer,
                                 EvidenceSink& sink) {
    clear_seen_through(beam, sink);
    for (const Beam& ended : answer.ended) {
        const auto voxels = cones_.find(ended);
        if (!voxels) continue;
        make_withdrawal(**voxels, evidence_);
        sink.apply(evidence_, nullptr);
    }
    for (const Beam& confirmed : answer.confirmed) confirm(confirmed, width_of(answer), sink);
}

void StationarySensors::clear_seen_through(const Beam& beam, EvidenceSink& sink) {
    const Beam* const through = seen_.take(beam, cones_.length_m(beam), histories_);
    // A zone with the history of a ray, for instance from another rig, has no cone.
    if (through == nullptr || !through->optics.is_cone()) return;
    const auto voxels = cones_.find(*through);
    if (!voxels) return;
    const std::function<bool(VoxelKey)> is_ranged = [&](VoxelKey key) {
        return seen_.any_newest(beam.captured, histories_,
                                [&](const Beam& other) { return cones_.ends_about(other, key); });
    };
    make_clearance(**voxels, evidence_);
    sink.apply(evidence_, &is_ranged);
}

/// An occupied voxel at the range's end also explains the range, wherever it lies in the cap.
void StationarySensors::confirm(const Beam& confirmed, CapWidth width, EvidenceSink& sink) {
    const Eigen::Vector3d p_map = confirmed.p_map_sensor + *confirmed.range_m * confirmed.direction_map;
    const auto end = cones_.lattice().key_of(p_map);
    // Usually the voxel that was marked once is still occupied, and no search is necessary.
    if (end && sink.is_occupied(*end)) return;
    // Near the edge of the octree, a mean of ranges may lie beyond it.
    const auto voxels = cones_.find(confirmed, width);
    if (!voxels) return;
    make_confirmation(**voxels, confirmed_.model().hits, evidence_);
    if (end) evidence_.add_cell(brick_of(*end), {static_cast<std::uint16_t>(cell_of(*end)), 1.0F});
    sink.apply(evidence_, nullptr);
}

}  // namespace octoskin
