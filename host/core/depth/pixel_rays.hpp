// The ray of every pixel, worked out once: where pixels become rays, the lens is taken out.
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
    /// Every pixel's centre must have a ray (asserted): the reader of the rig has refused what has not. With
    /// a lens about 50 ms, and 4 MiB for 512 x 424; without one as good as nothing.
    explicit PixelRays(const CameraIntrinsics& camera);

    [[nodiscard]] const CameraIntrinsics& camera() const noexcept { return camera_; }

    /// The ray through the centre of column `u`, row `v`.
    [[nodiscard]] RaySlope at(std::uint32_t u, std::uint32_t v) const noexcept {
        if (rays_.empty()) return {columns_[u].low, rows_[v].low};
        return rays_[std::size_t{v} * camera_.width + u];
    }

    /// Every column that has a ray whose x is from `low` to `high`, and perhaps a few more; empty if none
    /// has.
    [[nodiscard]] PixelSpan columns(double low, double high) const noexcept;
    /// The same of the rows and y.
    [[nodiscard]] PixelSpan rows(double low, double high) const noexcept;

  private:
    /// What the rays of a column have of x, or those of a row of y. Of a pinhole both are the same.
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
    std::vector<RaySlope> rays_;  ///< row-major; empty for a pinhole, whose rays columns and rows tell
};

}  // namespace octoskin
