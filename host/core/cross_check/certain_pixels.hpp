// Finds the reliable pixels of a depth image: those away from depth edges, from pixels without a value, and
// from pixels that the filter changed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

struct CertaintyConfig {
    double camera_sigma_m = 0.03;  ///< standard deviation of a pixel's raw depth
    bool is_filtered = true;       ///< false: the raw image is compared with itself
    /// Margins around every doubtful pixel: within the first, no surface is certain; within the second, it is
    /// not certain that the space before the surface is free. 2 and 3 cm at 2.5 m.
    double surface_margin_rad = 0.008;
    double clear_margin_rad = 0.012;
};

/// Certainty of a pixel.
enum class Certainty : std::uint8_t {
    none,     ///< anything may be present
    surface,  ///< the seen surface is there
    clear,    ///< and nothing is before it, however thin
};

/// Processes one image after the other; allocates no memory from the second image of a size on.
class CertainPixels {
  public:
    CertainPixels(const CameraIntrinsics& camera, const CertaintyConfig& config);

    /// `raw`: the camera's image; `filtered`: after the filter, with the robot; both of the camera's size
    /// (asserted). `certainty`: by pixel, row-major. A pixel is doubtful in three cases: either image has no
    /// value, the two differ by more than 4 sigma, or the inverse depth (linear in a plane) bends by a step
    /// of 10 cm or more (unfiltered: by 11 sigma). All pixels within the margins of a doubtful one, and of
    /// the image's border, are less certain. About 3 ms for 512 x 424.
    void find(const DepthImage& raw, const DepthImage& filtered, std::vector<Certainty>& certainty);

  private:
    void doubt_values(const DepthImage& raw, const DepthImage& filtered);
    void doubt_edges(const DepthImage& filtered);
    void raise(std::vector<Certainty>& certainty, std::size_t margin_px, Certainty to);

    std::size_t width_;
    std::size_t height_;
    std::size_t surface_margin_px_;
    std::size_t clear_margin_px_;
    float differ_max_m_;
    float step_max_m_;
    std::vector<float> inverse_depth_;
    std::vector<std::uint8_t> is_doubtful_;
    std::vector<std::uint8_t> in_row_;  ///< is_doubtful_, widened along its row
    std::vector<std::uint16_t> above_;  ///< number of doubtful rows of the window in a column
};

}  // namespace octoskin
