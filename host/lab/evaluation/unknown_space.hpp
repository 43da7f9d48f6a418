// Volume of unknown space around the robot during a replay: with the camera alone, and with the arm's range
// sensors added.
#pragma once

#include <optional>
#include <vector>

#include "host/core/query/unknown_pockets.hpp"

namespace octoskin::evaluation {

struct UnknownSample {
    double t_s = 0.0;                ///< from the first measurement on the map
    std::optional<double> depth_m3;  ///< unknown volume of the region; empty: no map of the camera alone
    double fused_m3 = 0.0;
};

/// A region seen from above, in columns of voxels.
struct UnknownColumns {
    double edge_m = 0.0;            ///< of a column
    std::size_t side = 0;           ///< columns along x and along y
    double low_x_m = 0.0;           ///< where the first one begins, from the region's centre
    double low_y_m = 0.0;           ///< the same
    std::vector<double> unknown_m;  ///< unknown height in each, x runs fastest; 0 outside the region
};

struct UnknownSpace {
    PocketRegion region;
    double region_m3 = 0.0;
    std::vector<UnknownSample> samples;  ///< by time
    // At the end:
    std::vector<UnknownPocket> pockets;           ///< of the fused map, the largest first
    std::optional<UnknownColumns> depth_columns;  ///< empty: no map of the camera alone
    UnknownColumns fused_columns;
};

/// Samples maps while a recording is replayed.
class UnknownSpaceMeter {
  public:
    /// A region that UnknownPockets refuses gives no samples.
    explicit UnknownSpaceMeter(const PocketRegion& region) { space_.region = region; }

    /// Call after each measurement that entered the map. Takes a sample if 0.25 s have passed since the last
    /// one. `depth` may be null. About 10 ms a sample at 4 cm and 1 m.
    void see(HostTime captured, const FusedMap* depth, const FusedMap& fused);
    /// The samples, and the state at the end.
    [[nodiscard]] UnknownSpace finish(const FusedMap* depth, const FusedMap& fused);

  private:
    void sample(HostTime captured, const FusedMap* depth, const FusedMap& fused);

    UnknownSpace space_;
    std::optional<HostTime> begin_;
    HostTime last_;
    HostTime next_;
};

}  // namespace octoskin::evaluation
