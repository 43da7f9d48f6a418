#include "host/core/mapping/image_writer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/core/bricks/brick_terms.hpp"

namespace octoskin {
namespace {

bool has_any_among(const BrickView& counts, const BrickMask& voxels) {
    if (counts.values == nullptr) return counts.value > 0.0F && voxels != BrickMask{};
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        if ((*counts.values)[cell] > 0.0F && contains(voxels, cell)) return true;
    }
    return false;
}

}  // namespace

void ImageWriter::write(const Evidence& image) noexcept {
    assert(std::isfinite(image.miss));
    for (const BrickEvidence& brick : image.bricks) {
        const auto cells = image.cells_of(brick);
        const auto done =
            editor_.has_counts(brick.first) ? write_priors(image, brick) : write_brick(image, brick);
        editor_.note(done, count_of(brick.voxels) + cells.size());
        if (!done) continue;
        BrickMask voxels = brick.voxels;
        for (const CellTerm& cell : cells) put_in(voxels, cell.cell);
        editor_.date(brick.first, voxels, image.sensor);
    }
}

/// A brick whose voxels are equal and stay equal takes a single value.
Status<MapRefusal> ImageWriter::write_brick(const Evidence& image, const BrickEvidence& brick) noexcept {
    MapLayers& layers = editor_.layers();
    const VoxelRules& rules = editor_.rules();
    const auto hits = image.cells_of(brick);
    const ClampedTerm miss = rules.missed(image.miss);
    const BrickView before = layers.log_odds.find(brick.first);
    const bool are_alike_before = before.values == nullptr && hits.empty();
    const float after = miss.added_to(before.value);
    if (are_alike_before && is_whole(brick.voxels)) {
        if (after == before.value) return Done{};
        const auto done = editor_.change(brick.first, [&] { layers.log_odds.set_all(brick.first, after); });
        if (done && before.is_unknown()) layers.known_voxels += kBrickVoxels;
        return done;
    }
    if (are_alike_before && after == before.value) return Done{};
    return editor_.change(brick.first, [&] {
        BrickValues& values = layers.log_odds.open(brick.first);
        layers.known_voxels += add_to_voxels(values, brick.voxels, miss);
        for (const CellTerm& hit : hits)
            editor_.set(values[hit.cell], rules.hit_by(hit.term).added_to(values[hit.cell]));
        if (hits.empty() && are_alike(values)) layers.log_odds.set_all(brick.first, values.front());
    });
}

/// In bricks with counts, the terms go to the priors, and counts that contradict them are reduced.
Status<MapRefusal> ImageWriter::write_priors(const Evidence& image, const BrickEvidence& brick) noexcept {
    CountLayer& counts = editor_.layers().counts;
    const VoxelRules& rules = editor_.rules();
    const CountModel& model = rules.counts();
    const auto new_hits = image.cells_of(brick);
    BrickMask marked{};
    for (const CellTerm& hit : new_hits)
        if (hit.term > 0.0F) put_in(marked, hit.cell);
    const bool clears =
        model.image_clears > 0.0F && has_any_among(counts.hits.find(brick.first), brick.voxels);
    const bool marks = model.image_marks > 0.0F && has_any_among(counts.misses.find(brick.first), marked);
    const BrickView prior = counts.prior.find(brick.first);
    const ClampedTerm miss = rules.missed(image.miss);
    const bool changes =
        clears || prior.values != nullptr || !new_hits.empty() || miss.added_to(prior.value) != prior.value;
    if (!changes) return Done{};
    return editor_.change(brick.first, [&] {
        BrickValues& log_odds = editor_.layers().log_odds.open(brick.first);
        BrickValues& priors = counts.prior.open(brick.first);
        BrickValues* const hits = clears ? &counts.hits.open(brick.first) : nullptr;
        BrickValues* const misses = marks ? &counts.misses.open(brick.first) : nullptr;
        const BrickView hits_now = counts.hits.find(brick.first);
        const BrickView misses_now = counts.misses.find(brick.first);
        const auto write = [&](std::size_t cell, const auto& rule) {
            VoxelState voxel{log_odds[cell], priors[cell], hits_now.at(cell), misses_now.at(cell)};
            rule(voxel);
            priors[cell] = voxel.prior;
            if (hits != nullptr) (*hits)[cell] = voxel.hits;
            if (misses != nullptr) (*misses)[cell] = voxel.misses;
            editor_.set(log_odds[cell], voxel.log_odds);
        };
        for_each_cell(brick.voxels, [&](std::size_t cell) {
            const bool is_at_clamp = miss.added_to(priors[cell]) == priors[cell];
            if (is_at_clamp && !(clears && hits_now.at(cell) > 0.0F)) return;  // most of free space
            write(cell, [&](VoxelState& voxel) { rules.miss(voxel, image.miss); });
        });
        for (const CellTerm& hit : new_hits)
            write(hit.cell, [&](VoxelState& voxel) { rules.hit(voxel, hit.term); });
    });
}

}  // namespace octoskin
