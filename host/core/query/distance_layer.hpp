// The exact distance from each voxel to the nearest voxel of a set; it is updated when the set changes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/query/brick_grid.hpp"
#include "host/core/query/layer_sweep.hpp"

namespace octoskin {

/// The voxels of a brick that belong to the set: in slice z, bit x + 8 y.
using SiteSlices = std::array<std::uint64_t, kBrickEdge>;

/// Squared Euclidean distances between voxel centres, in voxels, up to a reach, for the voxels of a region.
/// Computed one axis after the other (Felzenszwalb and Huttenlocher 2012, eq. 5). The values of each step are
/// kept, so that a change costs only the rows of voxels that it can affect. Takes about 1 KiB per axis for
/// each brick that differs from the initial state.
class DistanceLayer {
  public:
    static constexpr int kReachMax = 120;  ///< voxels: sums of two squares fit 15 bits

    /// `is_site_elsewhere`: whether voxels that were never set belong to the set. `reach`: 1 to kReachMax
    /// voxels (asserted). Distances are available in `region`, to sites up to `reach` outside of it.
    DistanceLayer(bool is_site_elsewhere, int reach, const BrickBox& region);

    /// The bricks whose sites affect a region.
    [[nodiscard]] static BrickBox sites_box(const BrickBox& region, int reach) noexcept;
    [[nodiscard]] const BrickBox& sites_box() const noexcept { return sites_.box(); }
    /// Sets the voxels of a brick of `sites_box()` that belong to the set. False if there is no change.
    /// Throws std::bad_alloc; the object is then invalid.
    bool set_sites(const BrickPlace& brick, const SiteSlices& sites);
    /// True if the brick is in its initial state.
    [[nodiscard]] bool is_plain(const BrickPlace& brick) const noexcept {
        return sites_.find(brick) == nullptr;
    }
    /// Updates the distances to the present set; before this call they are those of the set before. Returns
    /// how many layers of 64 voxels were computed, counted per axis: about 0.1 us each. Throws
    /// std::bad_alloc; the object is then invalid.
    std::size_t settle();

    /// Squared distance of a voxel of the region. Empty: beyond the reach.
    [[nodiscard]] std::optional<int> squared(VoxelKey key) const noexcept {
        const Value value = value_at(Axis::z, key);
        if (value >= beyond_) return std::nullopt;
        return value;
    }
    /// One of the nearest voxels of the set; empty if none is within reach, or only space outside the octree.
    /// About 0.2 us.
    [[nodiscard]] std::optional<VoxelKey> nearest(VoxelKey key) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const noexcept;

  private:
    using Value = std::int16_t;
    static constexpr auto kEdge = static_cast<std::size_t>(kBrickEdge);
    /// A brick's squared distances after a sweep. The sweeps along y and z work layer by layer: in the sweep
    /// along y the layers of different z are independent, in the sweep along z those of different y.
    struct Values {
        SweptRows rows{};    ///< after x: by z + 8 y; after y and z: by y + 8 z
        OfLayers least{};    ///< least value of each layer of the next sweep
        OfLayers largest{};  ///< largest value of each layer of this sweep; not for x
    };
    /// The state after the sweep along an axis.
    struct Stage {
        explicit Stage(const BrickBox& box) : values(box), due(box.bricks()) {}
        BrickGrid<Values> values;
        std::vector<std::uint64_t> due;       ///< rows (x) or layers of each brick to be computed
        std::vector<std::size_t> bricks_due;  ///< bricks with any
    };
    /// The swept values that changed, by layer of the next sweep.
    struct Change {
        std::uint64_t layers = 0;
        OfLayers least{};  ///< least of the changed values, old and new
    };

    [[nodiscard]] Stage& stage(Axis axis) noexcept { return stages_[static_cast<std::size_t>(axis)]; }
    [[nodiscard]] const Stage& stage(Axis axis) const noexcept {
        return stages_[static_cast<std::size_t>(axis)];
    }
    [[nodiscard]] const Values& values_of(Axis axis, const BrickPlace& brick) const noexcept {
        const Values* const values = stage(axis).values.find(brick);
        return values != nullptr ? *values : plain_;
    }
    [[nodiscard]] const SiteSlices& sites_of(const BrickPlace& brick) const noexcept {
        const SiteSlices* const sites = sites_.find(brick);
        return sites != nullptr ? *sites : plain_sites_;
    }
    [[nodiscard]] static std::size_t row_of(Axis after, std::size_t y, std::size_t z) noexcept {
        return after == Axis::x ? z + kEdge * y : y + kEdge * z;
    }
    [[nodiscard]] Value value_at(Axis axis, VoxelKey key) const noexcept {
        return values_of(axis, BrickPlace::of(key))
            .rows[row_of(axis, key.y % kEdge, key.z % kEdge)][key.x % kEdge];
    }
    [[nodiscard]] bool is_site(VoxelKey key) const noexcept {
        return (sites_of(BrickPlace::of(key))[key.z % kEdge] >> (key.x % kEdge + kEdge * (key.y % kEdge)) &
                1U) != 0;
    }
    template <class IsNearest>
    [[nodiscard]] std::optional<VoxelKey> step_to(VoxelKey key, Axis axis, const IsNearest& is_nearest) const;

    static void want(Stage& stage, const BrickPlace& brick, std::uint64_t parts);
    void spread_sites(const BrickPlace& brick, std::uint64_t rows);
    void spread(Axis next, const BrickPlace& brick, const Change& change);
    std::size_t sweep_due(Axis axis);
    void sweep_x(const BrickPlace& brick, std::uint64_t rows, SweptRows& swept) const;
    [[nodiscard]] std::uint64_t sweep(Axis axis, const BrickPlace& brick, unsigned layers, SweptRows& swept,
                                      OfLayers& largest) const;
    Change take(Stage& stage, std::size_t index, std::uint64_t rows, const SweptRows& swept,
                const OfLayers& largest);

    int reach_;
    int brick_reach_;
    Value beyond_;
    SiteSlices plain_sites_{};
    Values plain_;  ///< values of a brick in its initial state
    BrickGrid<SiteSlices> sites_;
    std::array<Stage, kAxisCount> stages_;
};

}  // namespace octoskin
