// Where the camera can be checked: an arm that swings before a corner, whose three walls its sensors range.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/pipeline/map_builder.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin::test {

/// `rig` (one_joint_rig) with a camera of 100 x 100 pixels, and two sensors of kLeft that look sideways and
/// upwards in place of two that it has.
[[nodiscard]] HostRig in_corner(HostRig rig);

/// Gives a builder what is measured there. Three sensors range the corner as the camera has it, which shows
/// where the camera is; kGood may range less.
class CornerLooks {
  public:
    /// `rig`: as `in_corner` gives it, and as `builder` was built with. Begins with 300 looks without kGood.
    CornerLooks(MapBuilder& builder, const HostRig& rig, double begin_s = 1.0);

    /// The next image, 0.1 s after the one before. What became of kGood's reading, which is less by `off_m`;
    /// empty: it does not range.
    Status<ReadingReason> look(std::optional<double> off_m);
    /// Looks until the reading is refused, or is not, for so many images at most; how many it took, or 0.
    int look_until(double off_m, bool is_refused, int images_max = 600);
    /// Of the newest image.
    [[nodiscard]] HostTime now() const noexcept { return now_; }

  private:
    [[nodiscard]] RangeMeasurement reading(std::uint8_t sensor, double angle, double off_m) const;
    [[nodiscard]] DepthFrame frame() const;

    MapBuilder& builder_;
    HostRig rig_;
    double begin_s_;
    int image_ = 0;
    HostTime now_{};
};

}  // namespace octoskin::test
