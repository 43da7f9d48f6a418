// What one measurement says about space, brick by brick. Every sensor model returns it, and nothing else goes
// into a map. VoxelRules says what each rule does to a voxel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/cell_term.hpp"
#include "host/core/voxels/sensor_kind.hpp"
#include "host/core/voxels/voxel_update.hpp"

namespace octoskin {

enum class EvidenceRule : std::uint8_t {
    /// Log-odds of a depth image: VoxelRules::miss for `voxels`, by `miss`, VoxelRules::hit for `cells`.
    image,
    /// Log-odds of anything else: VoxelRules::add for both.
    terms,
    /// VoxelRules::count: `voxels` get `miss` misses each, `cells` share `hit` hits in proportion to their
    /// term and to how probably they are occupied.
    counts,
    /// VoxelRules::confirm: `voxels` are occupied from now on, with at least `hit` hits, unless a voxel of
    /// `cells` with a term is occupied, which explains the measurement.
    confirm,
    /// VoxelRules::withdraw: `voxels` that are not occupied lose their hits.
    withdraw,
    /// VoxelRules::clear: `voxels` that are occupied are free from now on.
    clear,
};

/// All that a measurement says about one brick.
struct BrickEvidence {
    MortonCode first = 0;           ///< of the brick's voxels
    BrickMask voxels{};             ///< to which the same happens
    std::uint32_t cells_begin = 0;  ///< of `Evidence::cells`: those with a term of their own
    std::uint32_t cells_end = 0;
    friend bool operator==(const BrickEvidence&, const BrickEvidence&) = default;
};

struct Evidence {
    EvidenceRule rule = EvidenceRule::image;
    SensorKind sensor = SensorKind::camera;
    bool prefers_occupied = false;  ///< `counts`: occupied voxels alone share the hits, if there are any
    float miss = 0.0F;
    float hit = 0.0F;
    /// In the order in which they are applied. Of an image: each once, in Morton order, each voxel once at
    /// most, no term of 0. Of others a brick may come again.
    std::vector<BrickEvidence> bricks;
    std::vector<CellTerm> cells;  ///< by brick, in the order of the bricks

    [[nodiscard]] std::span<const CellTerm> cells_of(const BrickEvidence& brick) const noexcept {
        return std::span(cells).subspan(brick.cells_begin, brick.cells_end - brick.cells_begin);
    }
    [[nodiscard]] bool empty() const noexcept { return bricks.empty(); }
    /// How many voxels it is about. O(bricks).
    [[nodiscard]] std::size_t size() const noexcept;
    friend bool operator==(const Evidence&, const Evidence&) = default;

    // To build it. All may throw std::bad_alloc.

    void clear() noexcept {
        bricks.clear();
        cells.clear();
    }
    /// The brick's entry, which begins here if the last one is of another brick.
    [[nodiscard]] BrickEvidence& last(MortonCode brick);
    /// Adds to `voxels` of a brick that comes next or came last; nothing if there is none, or `miss` is 0.
    void add(MortonCode brick, const BrickMask& voxels);
    /// Adds a cell to a brick that comes next or came last; a term of 0 is none.
    void add_cell(MortonCode brick, CellTerm cell);
    /// Adds another image part's evidence of the same miss, all later in Morton order.
    void append(const Evidence& later);
    /// An image's, of voxels in any order, each once, in place of what is here. A term equal to `miss` is
    /// one.
    void take_image(std::vector<VoxelUpdate> updates);
    /// Terms of voxels in this order, whatever they are, in place of what is here. About 1 ns a voxel.
    void take_in_order(std::span<const VoxelUpdate> updates);
};

/// What else is to be done with an evidence. Both may be null.
struct EvidenceOptions {
    /// `clear`: voxels that stay as they are, because another measurement sees them. Called for occupied
    /// voxels only.
    const std::function<bool(VoxelKey)>* spares = nullptr;
    /// Gets by how much each voxel's log-odds changed; not by an image or `terms`, which say so themselves.
    std::vector<VoxelUpdate>* changes = nullptr;
};

/// What a voxel gets by an image; 0: nothing.
[[nodiscard]] float term_of(const Evidence& image, VoxelKey key) noexcept;

/// Calls visit(VoxelUpdate) for each voxel of an image or of `terms`: by brick, those of `voxels` before
/// those of `cells`.
template <class Visit>
void for_each_term(const Evidence& evidence, const Visit& visit) {
    for (const BrickEvidence& brick : evidence.bricks) {
        for_each_cell(brick.voxels, [&](std::size_t cell) {
            visit(VoxelUpdate{key_of_morton(brick.first + cell), evidence.miss});
        });
        for (const CellTerm& cell : evidence.cells_of(brick))
            visit(VoxelUpdate{key_of_morton(brick.first + cell.cell), cell.term});
    }
}

/// Evidence of terms of voxels in this order, by any sensor but a camera. Throws std::bad_alloc.
[[nodiscard]] Evidence evidence_of(std::span<const VoxelUpdate> updates,
                                   SensorKind sensor = SensorKind::range);

}  // namespace octoskin
