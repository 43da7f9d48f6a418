// A map for figures: curved, noisy surfaces with free space before them, of which bricks change.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/io/watch/map_changes.hpp"

namespace octoskin::bridge_bench {

class Sheets {
  public:
    /// Four surfaces with about `occupied` voxels together, each below four free ones. O(occupied).
    Sheets(std::size_t occupied, double resolution_m);

    /// Exchanges occupied and free voxels in `share` of the bricks; the number of either stays. Returns these
    /// bricks.
    watch::BrickCodes change(double share);
    /// Shares the bricks.
    [[nodiscard]] FusedMap map() const;
    [[nodiscard]] std::size_t bricks() const noexcept { return bricks_.size(); }
    [[nodiscard]] std::size_t known() const noexcept { return known_; }

  private:
    void add_column(int x, int y, int z);
    void set(VoxelKey key, float log_odds);
    void change_brick(MortonCode brick);

    double resolution_m_;
    BrickTree log_odds_;
    StampTree stamps_;
    watch::BrickCodes bricks_;
    std::size_t known_ = 0;
    std::mt19937 chance_{1};
    std::uint32_t clock_ = 100;
};

}  // namespace octoskin::bridge_bench
