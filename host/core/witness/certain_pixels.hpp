// Which pixels of a depth image show without doubt what is there: those away from depth edges, from pixels
// without a value, and from where the filter changed what the camera measured.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin {

struct CertaintyConfig {
    double camera_sigma_m = 0.03;  ///< of a pixel's depth as it came
    bool is_filtered = true;       ///< else the image as it came is compared with itself
    /// About every doubtful pixel: within the first no surface is certain, within the second not that nothing
    /// is before what is seen. 2 and 3 cm at 2.5 m.
    double surface_margin_rad = 0.008;
    double clear_margin_rad = 0.012;
};

/// Of a pixel.
enum class Certainty : std::uint8_t {
    none,     ///< there may be anything
    surface,  ///< what is seen is there
    clear,    ///< and nothing is before it, however thin
};

/// Finds them in one image after the other; from the second of a size on it takes no memory.
class CertainPixels {
  public:
    CertainPixels(const CameraIntrinsics& camera, const CertaintyConfig& config);

    /// `raw`: as the camera gave it; `filtered`: after the filter, with the robot in it; both of the camera's
    /// size (asserted). `certainty`: by pixel, row-major. A pixel is doubtful if either image has no
    /// value there, if the two differ by more than 4 sigma, or if the inverse depth, which is linear in a
    /// plane, bends there by a step of 10 cm or more (unfiltered: by 11 sigma); all within the
    /// margins of one, and of the image's border, is less certain. About 3 ms for 512 x 424.
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
    std::vector<std::uint16_t> above_;  ///< how many rows of the window are doubtful in a column
};

}  // namespace octoskin
