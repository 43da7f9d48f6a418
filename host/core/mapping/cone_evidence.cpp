#include "host/core/mapping/cone_evidence.hpp"

#include <span>
#include <utility>

namespace octoskin {
namespace {

void begin(Evidence& evidence, EvidenceRule rule) {
    evidence.clear();
    evidence.rule = rule;
    evidence.sensor = SensorKind::range;
    evidence.prefers_occupied = false;
    evidence.miss = 0.0F;
    evidence.hit = 0.0F;
}

/// In the cap's order, because the sum of shares depends on it.
void add_cells(std::span<const CapVoxel> cap, Evidence& evidence) {
    for (const CapVoxel& voxel : cap) {
        BrickEvidence& brick = evidence.last(brick_of(voxel.key));
        evidence.cells.push_back({static_cast<std::uint16_t>(cell_of(voxel.key)), voxel.weight});
        brick.cells_end = static_cast<std::uint32_t>(evidence.cells.size());
    }
}

/// Adds each brick once, after the existing entries, in the order of its first voxel. Voxels come in rows,
/// and adjacent rows are in the same few bricks: the wanted brick is usually among the last.
template <class Voxels, class KeyOf>
void add_voxels(const Voxels& voxels, const KeyOf& key_of, Evidence& evidence) {
    const std::size_t first = evidence.bricks.size();
    const auto none = static_cast<std::uint32_t>(evidence.cells.size());
    std::size_t place = 0;
    VoxelKey last;
    bool has_place = false;
    for (const auto& voxel : voxels) {
        const VoxelKey key = key_of(voxel);
        if (!has_place || !are_of_one_brick(key, last)) {
            const MortonCode brick = brick_of(key);
            place = evidence.bricks.size();
            while (place > first && evidence.bricks[place - 1].first != brick) --place;
            if (place == first) {
                evidence.bricks.push_back({brick, {}, none, none});
                place = evidence.bricks.size();
            }
            --place;
            has_place = true;
        }
        last = key;
        put_in(evidence.bricks[place].voxels, cell_of(key));
    }
}

VoxelKey itself(VoxelKey key) {
    return key;
}

}  // namespace

void make_counts(const ConeVoxels& cone, const ConeModel& model, bool prefers_occupied, Evidence& evidence) {
    begin(evidence, EvidenceRule::counts);
    evidence.prefers_occupied = prefers_occupied;
    evidence.miss = model.miss_mass;
    evidence.hit = model.hit_mass;
    add_cells(cone.cap, evidence);
    add_voxels(cone.passed, itself, evidence);
}

void make_confirmation(const ConeVoxels& cone, float hits, Evidence& evidence) {
    begin(evidence, EvidenceRule::confirm);
    evidence.hit = hits;
    add_cells(cone.cap, evidence);
    add_voxels(cone.middle, itself, evidence);
}

void make_withdrawal(const ConeVoxels& cone, Evidence& evidence) {
    begin(evidence, EvidenceRule::withdraw);
    add_voxels(
        cone.cap, [](const CapVoxel& voxel) { return voxel.key; }, evidence);
}

void make_clearance(const ConeVoxels& cone, Evidence& evidence) {
    begin(evidence, EvidenceRule::clear);
    add_voxels(cone.passed, itself, evidence);
}

}  // namespace octoskin
