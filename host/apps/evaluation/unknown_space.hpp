// How much of the space about the robot nobody has seen yet, while a recording is played: with the camera
// alone, and with range sensors on the arm beside it.
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

struct UnknownSpace {
    PocketRegion region;
    double region_m3 = 0.0;
    std::vector<UnknownSample> samples;  ///< by time
    std::vector<UnknownPocket> pockets;  ///< of the fused map at the end, the largest first
};

/// Samples maps on their way.
class UnknownSpaceMeter {
  public:
    /// A region that UnknownPockets refuses gives no samples.
    explicit UnknownSpaceMeter(const PocketRegion& region) { space_.region = region; }

    /// After each measurement that went in: a sample if a quarter of a second has passed. `depth` may be
    /// null. About 10 ms a sample at 4 cm and 1 m.
    void see(HostTime captured, const FusedMap* depth, const FusedMap& fused);
    /// What was sampled, and the state at the end.
    [[nodiscard]] UnknownSpace finish(const FusedMap* depth, const FusedMap& fused);

  private:
    void sample(HostTime captured, const FusedMap* depth, const FusedMap& fused);

    UnknownSpace space_;
    std::optional<HostTime> begin_;
    HostTime last_;
    HostTime next_;
};

}  // namespace octoskin::evaluation
