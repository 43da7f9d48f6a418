// How far each voxel is from the nearest of a set of voxels, exactly, kept up as the set changes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/query/brick_grid.hpp"
#include "host/core/query/layer_sweep.hpp"

namespace octoskin {

/// The voxels of a brick that are of the set: of slice z bit x + 8 y.
using SiteSlices = std::array<std::uint64_t, kBrickEdge>;

/// Squared Euclidean distances between voxel centres, in voxels, up to a reach, of the voxels of a region.
/// Found one axis after the other (Felzenszwalb and Huttenlocher 2012, eq. 5): each step's values are kept,
/// so that a change costs only the rows of voxels whose values it may change. Takes about 1 KiB for each axis
/// and each brick that is not as it is without any change.
class DistanceLayer {
  public:
    static constexpr int kReachMax = 120;  ///< voxels: sums of two squares fit 15 bits

    /// `is_site_elsewhere`: whether voxels that nobody spoke of are of the set. `reach`: 1 to kReachMax
    /// voxels (asserted). Distances are told in `region`, and to what is up to `reach` outside of it.
    DistanceLayer(bool is_site_elsewhere, int reach, const BrickBox& region);

    /// Of which bricks sites matter to a region.
    [[nodiscard]] static BrickBox sites_box(const BrickBox& region, int reach) noexcept;
    [[nodiscard]] const BrickBox& sites_box() const noexcept { return sites_.box(); }
    /// From now on these voxels of the brick, one of `sites_box()`, are of the set, and no others of it.
    /// False: they were already. Throws std::bad_alloc; then all is void.
    bool set_sites(const BrickPlace& brick, const SiteSlices& sites);
    /// Whether the brick is as if nobody had spoken of it.
    [[nodiscard]] bool is_plain(const BrickPlace& brick) const noexcept {
        return sites_.find(brick) == nullptr;
    }
    /// Makes the distances those of the set as it is now; until then they are those before. The answer is how
    /// many layers of 64 voxels it worked on, counted for each axis: 0.1 us each, about. Throws
    /// std::bad_alloc; then all is void.
    std::size_t settle();

    /// Of a voxel of the region. Empty: beyond the reach.
    [[nodiscard]] std::optional<int> squared(VoxelKey key) const noexcept {
        const Value value = value_at(Axis::z, key);
        if (value >= beyond_) return std::nullopt;
        return value;
    }
    /// One of the voxels that are so near to this one; empty if none is, or only what is outside the octree.
    /// Some 0.2 us.
    [[nodiscard]] std::optional<VoxelKey> nearest(VoxelKey key) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const noexcept;

  private:
    using Value = std::int16_t;
    static constexpr auto kEdge = static_cast<std::size_t>(kBrickEdge);
    /// A brick's squared distances after a sweep. The sweeps along y and z go layer by layer: in one the rows
    /// of each z, in the other those of each y know nothing of others.
    struct Values {
        SweptRows rows{};    ///< after x: by z + 8 y; after y and z: by y + 8 z
        OfLayers least{};    ///< of each layer of the next sweep
        OfLayers largest{};  ///< of each layer of this sweep, but for x
    };
    /// After the sweep along an axis.
    struct Stage {
        explicit Stage(const BrickBox& box) : values(box), due(box.bricks()) {}
        BrickGrid<Values> values;
        std::vector<std::uint64_t> due;       ///< of each brick rows (x) or layers that have to be worked out
        std::vector<std::size_t> bricks_due;  ///< those with any
    };
    /// What was swept and has other values now, by layer of the next sweep.
    struct Change {
        std::uint64_t layers = 0;
        OfLayers least{};  ///< of what changed, before and now
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
    Values plain_;  ///< of a brick that is as if nobody had spoken of it
    BrickGrid<SiteSlices> sites_;
    std::array<Stage, kAxisCount> stages_;
};

}  // namespace octoskin
