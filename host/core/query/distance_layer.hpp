// How far each voxel is from the nearest of a set of voxels, exactly, kept up as the set changes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "host/core/bricks/brick.hpp"

namespace octoskin {

/// The voxels of a brick that are of the set: of slice z bit x + 8 y.
using SiteSlices = std::array<std::uint64_t, kBrickEdge>;

/// Squared Euclidean distances between voxel centres, in voxels, up to a reach. Found one axis after the
/// other (Felzenszwalb and Huttenlocher 2012, eq. 5): each step's values are kept, so that a change costs
/// only the bricks whose values it changes, and their neighbours along the axes. Takes about 3.3 KiB for
/// each brick that is not as it is without any change.
class DistanceLayer {
  public:
    static constexpr int kReachMax = 120;  ///< voxels: sums of two squares fit 15 bits

    /// `is_site_elsewhere`: whether voxels that nobody spoke of are of the set. `reach`: 1 to kReachMax
    /// voxels (asserted).
    DistanceLayer(bool is_site_elsewhere, int reach);

    /// From now on these voxels of the brick are of the set, and no others of it. False: they were already.
    bool set_sites(MortonCode brick, const SiteSlices& sites);
    /// Makes the distances those of the set as it is now; until then they are those before. The answer is how
    /// many bricks it worked on, counted for each axis: about 1 us each. Throws std::bad_alloc; then all is
    /// void.
    std::size_t settle();

    /// Empty: beyond the reach.
    [[nodiscard]] std::optional<int> squared(VoxelKey key) const noexcept;
    [[nodiscard]] std::size_t memory_bytes() const noexcept;

  private:
    using Value = std::int16_t;
    static constexpr std::size_t kSlab = kBrickEdge * kBrickEdge;
    using Slab = std::array<Value, kSlab>;
    enum class Axis : std::uint8_t { z, y, x };
    static constexpr std::array kAxes{Axis::z, Axis::y, Axis::x};  ///< in the order of the sweeps

    /// A brick's squared distances after a sweep, in the slabs that the next sweep goes along.
    struct Values {
        std::array<Slab, kBrickEdge> slabs{};
        std::array<Value, kBrickEdge> least{};  ///< of each slab
    };
    struct Brick {
        SiteSlices sites{};
        std::array<Values, 3> after{};  ///< z: by y, x + 8 z; y and x: by x, y + 8 z
    };
    using BrickKey = std::uint64_t;

    [[nodiscard]] const Brick* find(BrickKey key) const noexcept;
    Brick& open(BrickKey key);
    [[nodiscard]] std::vector<BrickKey> neighbours(const std::vector<BrickKey>& changed, Axis axis) const;
    bool sweep(BrickKey key, Axis axis);
    [[nodiscard]] Values along_z(BrickKey key) const;
    [[nodiscard]] Values along(BrickKey key, Axis axis) const;
    void drop_plain(const std::vector<BrickKey>& touched);

    int reach_;
    int brick_reach_;
    Value beyond_;
    Value elsewhere_;  ///< what every value is where no brick is
    Brick plain_;      ///< one that is as if nobody had spoken of it
    std::unordered_map<BrickKey, std::unique_ptr<Brick>> bricks_;
    std::vector<BrickKey> changed_;
};

}  // namespace octoskin
