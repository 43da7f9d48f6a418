#include "host/core/mapping/evidence.hpp"

#include <algorithm>
#include <cassert>

#include "host/core/bricks/brick_runs.hpp"

namespace octoskin {
namespace {

bool is_none(const BrickMask& voxels) {
    return std::ranges::all_of(voxels, [](std::uint64_t word) { return word == 0; });
}

/// Writes all cells at once, because the end of a run is unpredictable for a processor. Entries are
/// constructed in place: a copy would wait for the writes that it reads.
void append_runs(std::span<const VoxelUpdate> updates, const BrickRuns& found, Evidence& evidence) {
    const std::size_t before = evidence.cells.size();
    for (std::size_t i = 0; i < found.updates; ++i)
        evidence.cells.push_back({static_cast<std::uint16_t>(found.cell_of[i]), updates[i].log_odds});
    for (std::size_t run = 0; run < found.runs; ++run) {
        const std::size_t begin = found.first_of[run];
        const std::size_t end = run + 1 < found.runs ? found.first_of[run + 1] : found.updates;
        BrickEvidence& brick = evidence.bricks.emplace_back();
        brick.first = brick_of(updates[begin].key);
        brick.cells_begin = static_cast<std::uint32_t>(before + begin);
        brick.cells_end = static_cast<std::uint32_t>(before + end);
    }
}

}  // namespace

BrickEvidence& Evidence::last(MortonCode brick) {
    if (bricks.empty() || bricks.back().first != brick) {
        const auto begin = static_cast<std::uint32_t>(cells.size());
        bricks.push_back({.first = brick, .voxels = {}, .cells_begin = begin, .cells_end = begin});
    }
    return bricks.back();
}

void Evidence::add(MortonCode brick, const BrickMask& voxels) {
    if (!is_none(voxels) && miss != 0.0F) last(brick).voxels = voxels;
}

void Evidence::add_cell(MortonCode brick, CellTerm cell) {
    if (cell.term == 0.0F) return;
    BrickEvidence& entry = last(brick);
    cells.push_back(cell);
    entry.cells_end = static_cast<std::uint32_t>(cells.size());
}

void Evidence::append(const Evidence& later) {
    assert(miss == later.miss);
    assert(bricks.empty() || later.bricks.empty() || bricks.back().first < later.bricks.front().first);
    const auto shift = static_cast<std::uint32_t>(cells.size());
    for (BrickEvidence brick : later.bricks) {
        brick.cells_begin += shift;
        brick.cells_end += shift;
        bricks.push_back(brick);
    }
    cells.insert(cells.end(), later.cells.begin(), later.cells.end());
}

void Evidence::take_image(std::vector<VoxelUpdate> updates) {
    clear();
    std::ranges::sort(updates, {}, [](const VoxelUpdate& update) { return morton_of(update.key); });
    for (const VoxelUpdate& update : updates) {
        const MortonCode brick = brick_of(update.key);
        const std::size_t cell = cell_of(update.key);
        if (update.log_odds != miss) {
            add_cell(brick, {static_cast<std::uint16_t>(cell), update.log_odds});
        } else if (miss != 0.0F) {
            put_in(last(brick).voxels, cell);
        }
    }
}

void Evidence::take_in_order(std::span<const VoxelUpdate> updates) {
    clear();
    cells.reserve(updates.size());
    BrickRuns found;
    while (!updates.empty()) {
        find_runs(updates, found);
        append_runs(updates, found, *this);
        updates = updates.subspan(found.updates);
        if (updates.empty()) return;
        // The end of a run, or a term that is 0 or not finite, which the map counts.
        const VoxelUpdate& next = updates.front();
        if (is_plain(next.log_odds)) continue;
        BrickEvidence& entry = last(brick_of(next.key));
        cells.push_back({static_cast<std::uint16_t>(cell_of(next.key)), next.log_odds});
        entry.cells_end = static_cast<std::uint32_t>(cells.size());
        updates = updates.subspan(1);
    }
}

std::size_t Evidence::size() const noexcept {
    std::size_t size = cells.size();
    for (const BrickEvidence& brick : bricks) size += count_of(brick.voxels);
    return size;
}

float term_of(const Evidence& image, VoxelKey key) noexcept {
    const auto brick = std::ranges::lower_bound(image.bricks, brick_of(key), {}, &BrickEvidence::first);
    if (brick == image.bricks.end() || brick->first != brick_of(key)) return 0.0F;
    const std::size_t cell = cell_of(key);
    if (contains(brick->voxels, cell)) return image.miss;
    const auto own = image.cells_of(*brick);
    const auto found =
        std::ranges::find(own, cell, [](const CellTerm& term) { return std::size_t{term.cell}; });
    return found == own.end() ? 0.0F : found->term;
}

Evidence evidence_of(std::span<const VoxelUpdate> updates, SensorKind sensor) {
    Evidence evidence{.rule = EvidenceRule::terms, .sensor = sensor, .bricks = {}, .cells = {}};
    evidence.take_in_order(updates);
    return evidence;
}

}  // namespace octoskin
