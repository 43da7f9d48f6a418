#include "host/core/mapping/weakening_writer.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin {

void WeakeningWriter::write(const Evidence& evidence) noexcept {
    for (const BrickEvidence& brick : evidence.bricks) {
        const BrickMask voxels = changed_in(brick);
        if (voxels == BrickMask{}) continue;
        Status<MapRefusal> done = Done{};
        try {
            write_brick(brick.first, voxels, evidence.miss);
        } catch (const std::bad_alloc&) {
            done = unexpected(&MapCounters::no_memory);
        }
        editor_.note(done, count_of(voxels));
    }
}

BrickMask WeakeningWriter::changed_in(const BrickEvidence& brick) const noexcept {
    const MapLayers& layers = editor_.layers();
    const BrickView priors = voxel_brick(layers, brick.first, layers.log_odds.find(brick.first)).prior;
    BrickMask changed{};
    for_each_cell(brick.voxels, [&](std::size_t cell) {
        if (editor_.rules().is_occupied(priors.at(cell))) put_in(changed, cell);
    });
    return changed;
}

void WeakeningWriter::write_brick(MortonCode brick, const BrickMask& voxels, float term) {
    MapLayers& layers = editor_.layers();
    BrickValues& log_odds = layers.log_odds.open(brick);
    BrickValues* const priors = editor_.has_counts(brick) ? &layers.counts.prior.open(brick) : nullptr;
    const VoxelBrick opened = voxel_brick(layers, brick, layers.log_odds.find(brick));
    const auto weakened = [&](std::size_t cell) {
        VoxelState voxel = opened.at(cell);
        editor_.rules().weaken(voxel, term);
        return voxel;
    };
    // Counts without effect keep their time stamp: without one they never expire.
    BrickMask without_evidence{};
    for_each_cell(voxels, [&](std::size_t cell) {
        const VoxelState voxel = weakened(cell);
        if (std::isnan(voxel.log_odds) && voxel.hits == 0.0F && voxel.misses == 0.0F)
            put_in(without_evidence, cell);
    });
    // May throw: nothing is written yet.
    if (changes_ != nullptr) changes_->reserve(changes_->size() + count_of(voxels));
    layers.ages.forget(brick, without_evidence);
    for_each_cell(voxels, [&](std::size_t cell) {
        const VoxelState voxel = weakened(cell);
        if (priors != nullptr) (*priors)[cell] = voxel.prior;
        layers.known_voxels -= !std::isnan(log_odds[cell]) && std::isnan(voxel.log_odds) ? 1U : 0U;
        const float change = voxel.log_odds - std::exchange(log_odds[cell], voxel.log_odds);
        if (changes_ != nullptr && !std::isnan(change) && change != 0.0F)
            changes_->push_back({key_of_morton(brick + cell), change});
    });
    if (std::ranges::all_of(log_odds, [](float value) { return std::isnan(value); }))
        layers.log_odds.forget(brick);
}

}  // namespace octoskin
