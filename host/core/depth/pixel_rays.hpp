// The ray of each pixel, computed once, with the lens distortion removed.
#pragma once

#include <cstdint>
#include <vector>

#include "common/lens/lens_distortion.hpp"
#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

/// Pixels [begin, end) of one axis.
struct PixelSpan {
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
};

class PixelRays {
  public:
    /// Each pixel's centre must have a ray (asserted); the rig reader rejects a camera without this. With a
    /// lens about 50 ms and 4 MiB for 512 x 424; without one the cost is negligible.
    explicit PixelRays(const CameraIntrinsics& camera);

    [[nodiscard]] const CameraIntrinsics& camera() const noexcept { return camera_; }

    /// The ray through the centre of column `u`, row `v`.
    [[nodiscard]] RaySlope at(std::uint32_t u, std::uint32_t v) const noexcept {
        if (rays_.empty()) return {columns_[u].low, rows_[v].low};
        return rays_[std::size_t{v} * camera_.width + u];
    }

    /// All columns that have a ray with x from `low` to `high`, and possibly a few more; empty if there is
    /// none.
    [[nodiscard]] PixelSpan columns(double low, double high) const noexcept;
    /// The same for rows and y.
    [[nodiscard]] PixelSpan rows(double low, double high) const noexcept;

  private:
    /// The range of x of a column's rays, or of y of a row's rays. For a pinhole camera `low` equals `high`.
    struct Extent {
        double low = 0.0;
        double high = 0.0;
    };
    [[nodiscard]] static PixelSpan span_of(const std::vector<Extent>& extents, double low,
                                           double high) noexcept;
    void take_lens_out();

    CameraIntrinsics camera_;
    std::vector<Extent> columns_;
    std::vector<Extent> rows_;
    /// Row-major. Empty for a pinhole camera, whose rays follow from columns_ and rows_.
    std::vector<RaySlope> rays_;
};

}  // namespace octoskin
