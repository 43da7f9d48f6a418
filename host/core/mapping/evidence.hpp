// What one measurement states about space, brick by brick. Every sensor model returns evidence, and nothing
// else is applied to a map. VoxelRules defines the effect of each rule on a voxel.
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
    /// VoxelRules::count: each of `voxels` gets `miss` misses. `cells` share `hit` hits in proportion to
    /// their term and to their probability of being occupied.
    counts,
    /// VoxelRules::confirm: `voxels` become occupied, with at least `hit` hits. If a voxel of `cells` with a
    /// term is already occupied, it explains the measurement, and nothing is changed.
    confirm,
    /// VoxelRules::withdraw: `voxels` that are not occupied lose their hits.
    withdraw,
    /// VoxelRules::clear: `voxels` that are occupied become free.
    clear,
    /// VoxelRules::weaken for `voxels`, by `miss`: the measurement contradicts that they are occupied, and
    /// does not show that they are free.
    weaken,
};

/// Everything that a measurement states about one brick.
struct BrickEvidence {
    MortonCode first = 0;           ///< code of the brick's first voxel
    BrickMask voxels{};             ///< voxels with the same term
    std::uint32_t cells_begin = 0;  ///< range in `Evidence::cells`: voxels with their own term
    std::uint32_t cells_end = 0;
    friend bool operator==(const BrickEvidence&, const BrickEvidence&) = default;
};

struct Evidence {
    EvidenceRule rule = EvidenceRule::image;
    SensorKind sensor = SensorKind::camera;
    bool prefers_occupied = false;  ///< for `counts`: if cells are occupied, only those share the hits
    float miss = 0.0F;
    float hit = 0.0F;
    /// In the order of application. For an image: each brick once, in Morton order, each voxel at most once,
    /// no term of 0. For other rules, a brick may occur again.
    std::vector<BrickEvidence> bricks;
    std::vector<CellTerm> cells;  ///< grouped by brick, in the order of `bricks`

    [[nodiscard]] std::span<const CellTerm> cells_of(const BrickEvidence& brick) const noexcept {
        return std::span(cells).subspan(brick.cells_begin, brick.cells_end - brick.cells_begin);
    }
    [[nodiscard]] bool empty() const noexcept { return bricks.empty(); }
    /// Number of voxels in the evidence. O(bricks).
    [[nodiscard]] std::size_t size() const noexcept;
    friend bool operator==(const Evidence&, const Evidence&) = default;

    // Functions that build evidence. All may throw std::bad_alloc.

    void clear() noexcept {
        bricks.clear();
        cells.clear();
    }
    /// The brick's entry; begins a new one if the last entry is of another brick.
    [[nodiscard]] BrickEvidence& last(MortonCode brick);
    /// Adds to `voxels` of the last or a following brick. Does nothing if the mask is empty or `miss` is 0.
    void add(MortonCode brick, const BrickMask& voxels);
    /// Adds a cell to the last or a following brick. A term of 0 is ignored.
    void add_cell(MortonCode brick, CellTerm cell);
    /// Appends evidence of another part of the image with the same `miss`, all later in Morton order.
    void append(const Evidence& later);
    /// Replaces the contents with an image's terms: voxels in any order, each once. A term equal to `miss` is
    /// a miss.
    void take_image(std::vector<VoxelUpdate> updates);
    /// Replaces the contents with any terms of voxels, in this order. About 1 ns a voxel.
    void take_in_order(std::span<const VoxelUpdate> updates);
};

/// Options for applying an evidence. Both may be null.
struct EvidenceOptions {
    /// For `clear`: selects voxels that stay unchanged because another measurement sees them. Called for
    /// occupied voxels only.
    const std::function<bool(VoxelKey)>* spares = nullptr;
    /// Gets the change of each voxel's log-odds; not for `image` and `terms`, whose evidence contains it, and
    /// not of a voxel that becomes unknown.
    std::vector<VoxelUpdate>* changes = nullptr;
};

/// The term of a voxel in an image; 0: none.
[[nodiscard]] float term_of(const Evidence& image, VoxelKey key) noexcept;

/// Calls visit(VoxelUpdate) for each voxel of an `image` or of `terms`: by brick, those of `voxels` before
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

/// Evidence with terms of voxels in this order, from any sensor except a camera. Throws std::bad_alloc.
[[nodiscard]] Evidence evidence_of(std::span<const VoxelUpdate> updates,
                                   SensorKind sensor = SensorKind::range);

}  // namespace octoskin
