#include "host/core/mapping/retraction_writer.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin {

void RetractionWriter::write(const Evidence& evidence) noexcept {
    for (const BrickEvidence& brick : evidence.bricks) {
        const BrickMask voxels = changed_in(brick);
        if (voxels == BrickMask{}) continue;
        Status<MapRefusal> done = Done{};
        try {
            write_brick(brick.first, voxels);
        } catch (const std::bad_alloc&) {
            done = unexpected(&MapCounters::no_memory);
        }
        editor_.note(done, count_of(voxels));
    }
}

BrickMask RetractionWriter::changed_in(const BrickEvidence& brick) const noexcept {
    const MapLayers& layers = editor_.layers();
    const BrickView priors = voxel_brick(layers, brick.first, layers.log_odds.find(brick.first)).prior;
    BrickMask changed{};
    for_each_cell(brick.voxels, [&](std::size_t cell) {
        if (editor_.rules().is_occupied(priors.at(cell))) put_in(changed, cell);
    });
    return changed;
}

void RetractionWriter::write_brick(MortonCode brick, const BrickMask& voxels) {
    MapLayers& layers = editor_.layers();
    BrickValues& log_odds = layers.log_odds.open(brick);
    BrickValues* const priors = editor_.has_counts(brick) ? &layers.counts.prior.open(brick) : nullptr;
    const VoxelBrick opened = voxel_brick(layers, brick, layers.log_odds.find(brick));
    const auto retracted = [&](std::size_t cell) {
        VoxelState voxel = opened.at(cell);
        editor_.rules().retract(voxel);
        return voxel;
    };
    // Counts without effect keep their time stamp: without one they never expire.
    BrickMask without_evidence{};
    for_each_cell(voxels, [&](std::size_t cell) {
        const VoxelState voxel = retracted(cell);
        if (std::isnan(voxel.log_odds) && voxel.hits == 0.0F && voxel.misses == 0.0F)
            put_in(without_evidence, cell);
    });
    layers.ages.forget(brick, without_evidence);  // may throw: nothing is written yet
    for_each_cell(voxels, [&](std::size_t cell) {
        const VoxelState voxel = retracted(cell);
        if (priors != nullptr) (*priors)[cell] = voxel.prior;
        layers.known_voxels -= !std::isnan(log_odds[cell]) && std::isnan(voxel.log_odds) ? 1U : 0U;
        log_odds[cell] = voxel.log_odds;
    });
    if (std::ranges::all_of(log_odds, [](float value) { return std::isnan(value); }))
        layers.log_odds.forget(brick);
}

}  // namespace octoskin
