#include "host/core/mapping/count_writer.hpp"

#include <algorithm>
#include <new>

#include "host/core/bricks/brick_sets.hpp"

namespace octoskin {

void CountWriter::write(const Evidence& evidence) {
    switch (evidence.rule) {
        case EvidenceRule::image:
        case EvidenceRule::terms:
        case EvidenceRule::weaken:
            return;  // written by ImageWriter, TermWriter and WeakeningWriter
        case EvidenceRule::counts:
            return count(evidence);
        case EvidenceRule::confirm:
            return confirm(evidence);
        case EvidenceRule::withdraw:
            return withdraw(evidence);
        case EvidenceRule::clear:
            return clear(evidence);
    }
}

bool CountWriter::note(const BrickEvidence& brick, std::size_t cell,
                       const Result<float, MapRefusal>& change) {
    editor_.note(change ? &MapCounters::applied : change.error());
    if (!change) return false;
    if (options_.changes != nullptr && *change != 0.0F)
        options_.changes->push_back({key_of_morton(brick.first + cell), *change});
    return true;
}

float CountWriter::share_of(const CellTerm& cell, bool of_occupied) const noexcept {
    const VoxelState voxel = brick_.at(cell.cell);
    if (of_occupied && !editor_.rules().is_occupied(voxel.log_odds)) return 0.0F;
    return cell.term * editor_.rules().probability(voxel);
}

float CountWriter::sum_of_shares(const Evidence& evidence, bool of_occupied) noexcept {
    float sum = 0.0F;
    for (const BrickEvidence& brick : evidence.bricks) {
        brick_.go_to(brick.first);
        for (const CellTerm& cell : evidence.cells_of(brick)) sum += share_of(cell, of_occupied);
    }
    return sum;
}

void CountWriter::count(const Evidence& evidence) {
    const VoxelRules& rules = editor_.rules();
    std::vector<Refused> refused;
    bool are_refused_known = true;
    const auto add = [&](const BrickEvidence& brick, std::size_t cell, float hits, float misses) {
        const auto change = brick_.change(cell, [&](VoxelState& voxel) { rules.count(voxel, hits, misses); });
        if (note(brick, cell, change)) return;
        const auto index = static_cast<std::size_t>(&brick - evidence.bricks.data());
        try {
            if (refused.empty() || refused.back().brick != index) refused.push_back({index, {}});
            put_in(refused.back().voxels, cell);
        } catch (const std::bad_alloc&) {
            are_refused_known = false;
            editor_.note(&MapCounters::ages_without_memory);
        }
    };
    bool of_occupied = evidence.prefers_occupied;
    float sum = sum_of_shares(evidence, of_occupied);
    if (sum == 0.0F && of_occupied) {
        of_occupied = false;
        sum = sum_of_shares(evidence, of_occupied);
    }
    for (const BrickEvidence& brick : evidence.bricks) {
        brick_.go_to(brick.first);
        if (sum > 0.0F) {
            // A voxel occurs once in a cap: its share depends only on its own earlier state, not on the
            // order.
            for (const CellTerm& cell : evidence.cells_of(brick)) {
                const float share = share_of(cell, of_occupied) / sum;
                if (share > 0.0F) add(brick, cell.cell, evidence.hit * share, 0.0F);
            }
        }
        for_each_cell(brick.voxels, [&](std::size_t cell) { add(brick, cell, 0.0F, evidence.miss); });
    }
    // Otherwise no voxel gets a time stamp: some may not be in the map.
    if (are_refused_known) date_range(evidence, refused);
}

void CountWriter::date_range(const Evidence& evidence, std::span<const Refused> refused) noexcept {
    const MapLayers& layers = editor_.layers();
    if (!layers.ages.has_begun()) return;
    const VoxelRules& rules = editor_.rules();
    for (std::size_t index = 0; index < evidence.bricks.size(); ++index) {
        const BrickEvidence& brick = evidence.bricks[index];
        const BrickView log_odds = layers.log_odds.find(brick.first);
        const StampView stamps = layers.ages.find(brick.first);
        const auto is_seen = [&](std::size_t cell) {
            return [&, cell] { return editor_.is_seen_by_camera(stamps.at(cell)); };
        };
        BrickMask dated{};
        for_each_cell(brick.voxels, [&](std::size_t cell) {
            if (rules.dates_passed(log_odds.at(cell), is_seen(cell))) put_in(dated, cell);
        });
        for (const CellTerm& cell : evidence.cells_of(brick)) {
            if (rules.dates_in_cap(log_odds.at(cell.cell), cell.term, is_seen(cell.cell)))
                put_in(dated, cell.cell);
        }
        if (!refused.empty() && refused.front().brick == index) {
            for (std::size_t word = 0; word < dated.size(); ++word)
                dated[word] &= ~refused.front().voxels[word];
            refused = refused.subspan(1);
        }
        if (dated != BrickMask{}) editor_.date(brick.first, dated, SensorKind::range);
    }
}

void CountWriter::date_one(const BrickEvidence& brick, std::size_t cell) noexcept {
    BrickMask voxel{};
    put_in(voxel, cell);
    editor_.date(brick.first, voxel, SensorKind::range);
}

void CountWriter::confirm(const Evidence& evidence) {
    const auto explains = [&](const BrickEvidence& brick) {
        return std::ranges::any_of(evidence.cells_of(brick), [&](const CellTerm& cell) {
            return cell.term > 0.0F && editor_.is_occupied(brick.first, cell.cell);
        });
    };
    if (std::ranges::any_of(evidence.bricks, explains)) return;
    for (const BrickEvidence& brick : evidence.bricks) {
        brick_.go_to(brick.first);
        for_each_cell(brick.voxels, [&](std::size_t cell) {
            const auto change =
                brick_.change(cell, [&](VoxelState& voxel) { editor_.rules().confirm(voxel, evidence.hit); });
            if (note(brick, cell, change)) date_one(brick, cell);
        });
    }
}

void CountWriter::withdraw(const Evidence& evidence) {
    for (const BrickEvidence& brick : evidence.bricks) {
        brick_.go_to(brick.first);
        for_each_cell(brick.voxels, [&](std::size_t cell) {
            if (editor_.rules().is_occupied(brick_.log_odds(cell)) || !(brick_.hits(cell) > 0.0F)) return;
            note(brick, cell,
                 brick_.change(cell, [&](VoxelState& voxel) { editor_.rules().withdraw(voxel); }));
        });
    }
}

void CountWriter::clear(const Evidence& evidence) {
    const auto is_spared = [&](const BrickEvidence& brick, std::size_t cell) {
        return options_.spares != nullptr && (*options_.spares)(key_of_morton(brick.first + cell));
    };
    for (const BrickEvidence& brick : evidence.bricks) {
        brick_.go_to(brick.first);
        for_each_cell(brick.voxels, [&](std::size_t cell) {
            if (!editor_.rules().is_occupied(brick_.log_odds(cell))) return;
            const std::uint16_t stamp = editor_.layers().ages.find(brick.first).at(cell);
            if (editor_.is_seen_by_camera(stamp) || is_spared(brick, cell)) return;
            const auto change = brick_.change(cell, [&](VoxelState& voxel) { editor_.rules().clear(voxel); });
            if (note(brick, cell, change)) date_one(brick, cell);
        });
    }
}

}  // namespace octoskin
