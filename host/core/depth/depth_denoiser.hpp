// Removes the noise of a depth camera: the mean of each pixel over time, then the mean of the pixels of one
// surface around it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/core/depth/denoised_row.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/noise_law.hpp"

namespace octoskin {

/// Over time: the mean of a pixel's values, each within `gate_sigmas` of it. One value outside is held back,
/// the second in a row begins a new mean. So does a step or a drift of the 5 x 5 pixels around it: the sum of
/// their differences in sigmas, divided by the root of their number, beyond `step_sigmas`; or its running
/// mean, which keeps `drift_memory` of itself, beyond `drift_sigmas`.
///
/// Over space: pairs of opposite neighbours of a pixel whose mean inverse depth agrees with its own within
/// `pair_sigmas`. The mean of a pair on a plane is the centre's value, whatever the slope: so slopes are
/// kept, and pixels beyond an edge do not agree. First the neighbours are averaged that touch the pixel, then
/// those 3 and 9 pixels away, whose values are such averages already: so a plane is averaged over 27 x 27
/// pixels, and each time the deviation that decides what agrees is a third of the one before. A pixel is
/// dropped if its further values and the pixels of the 5 x 5 around it that agree with it are fewer than
/// `support_min`: a value at an edge, between two surfaces.
struct DepthDenoiserConfig {
    DepthNoiseLaw noise;
    double gate_sigmas = 3.5;
    double step_sigmas = 3.5;
    double drift_sigmas = 1.6;
    double drift_memory = 0.6;
    std::uint32_t count_max = 100;
    double pair_sigmas = 3.0;
    std::uint32_t support_min = 3;
    /// An end is in doubt if it may as well lie in the next voxel along its ray: up to so many sigmas further
    /// or less far.
    double doubt_sigmas = 1.0;
    friend bool operator==(const DepthDenoiserConfig&, const DepthDenoiserConfig&) = default;
};

/// What is known of a camera's pixels from earlier images, row by row with a margin (DepthDenoiser).
struct PixelMemory {
    std::vector<float> mean_m;
    std::vector<float> count;  ///< see PixelMemoryRow
    std::vector<float> drift;
};

/// Takes the images of one camera in the order of their capture. Allocates no memory after its construction.
class DepthDenoiser {
  public:
    /// Sigmas and counts positive, the noise at least 0.1 mm (asserted).
    DepthDenoiser(const DepthDenoiserConfig& config, const CameraIntrinsics& camera);

    /// Whether an image was captured from the same place as those in the memory.
    enum class Memory : std::uint8_t { used, of_other_place };
    /// Denoises an image of the camera's size (asserted) in place; NaN: no value. The memory is as before
    /// until `keep`. About 2 ms for 512 x 424.
    void denoise(DepthImage& image, Memory memory);
    /// The last image becomes part of the memory, or replaces one of another place.
    void keep() noexcept { std::swap(memory_, next_); }

    /// Row-major; of each pixel of the last image kChangeFound, kChangeConfirmed or 0.
    [[nodiscard]] std::span<const std::uint8_t> changes() const noexcept { return changes_; }

    /// Row-major, of each pixel of the last image that has a value: `doubt_sigmas` sigmas of its depth,
    /// metres; 0 for a surface that a stationary camera has seen for less than 10 images. kDenoiserLanesMax
    /// further values may be read.
    [[nodiscard]] std::span<const float> doubts_m() const noexcept { return doubts_m_; }

    /// What is remembered of a pixel (PixelMemoryRow).
    struct Pixel {
        float mean_m = 0.0F;
        float count = 0.0F;
        float drift = 0.0F;
        friend bool operator==(const Pixel&, const Pixel&) = default;
    };
    [[nodiscard]] Pixel pixel(std::uint32_t u, std::uint32_t v) const noexcept;
    void set_pixel(std::uint32_t u, std::uint32_t v, const Pixel& pixel) noexcept;
    [[nodiscard]] std::uint32_t width() const noexcept { return width_; }
    [[nodiscard]] std::uint32_t height() const noexcept { return height_; }

  private:
    using Row = std::ptrdiff_t;  ///< of the image, also one outside it
    [[nodiscard]] bool has(Row v) const noexcept { return v >= 0 && v < static_cast<Row>(height_); }
    [[nodiscard]] static PixelMemoryRow row_of(PixelMemory& memory, std::size_t begin) noexcept;
    [[nodiscard]] std::size_t begin_of(std::size_t v) const noexcept { return v * stride_; }
    [[nodiscard]] PixelMemoryRow remembered(Memory memory, Row v) noexcept;
    // Each does its part for one row, and nothing for a row outside the image.
    void pool(Row v, const DepthImage& image, Memory memory);
    void take(Row v, Memory memory);
    void average(std::size_t level, Row v);
    void support(Row v);
    void write(Row v, DepthImage& image, Memory memory);

    /// The newest rows of something. Rows have margins that only the constructor and `limit` write.
    class Rows {
      public:
        Rows(std::size_t rows, std::size_t width, float outside);
        [[nodiscard]] float* at(Row v) noexcept {
            return values_.data() + static_cast<std::size_t>(v) % rows_ * stride_ + kDenoiserMargin;
        }
        /// What was computed behind the last pixel of the row is of no pixel.
        void limit(Row v) noexcept;

      private:
        std::size_t rows_;
        std::size_t width_;
        std::size_t stride_;
        float outside_;
        std::vector<float> values_;
    };
    struct PosteriorRows {
        PosteriorRows(std::size_t rows, std::size_t width);
        [[nodiscard]] PosteriorRow at(Row v) noexcept {
            return {inverse.at(v), variance.at(v), weight.at(v)};
        }
        Rows inverse;
        Rows variance;
        Rows weight;
    };
    [[nodiscard]] PosteriorRow averaged_at(std::size_t level, Row v) noexcept {
        return has(v) ? posteriors_[level].at(v) : outside_.at(0);
    }

    DenoiserRule rule_;
    std::uint32_t width_;
    std::uint32_t height_;
    std::size_t stride_;
    PixelMemory memory_;
    PixelMemory next_;
    std::vector<float> nothing_;  ///< a row of zeros
    Rows depth_m_;
    Rows innovations_;
    Rows known_;
    Rows pooled_;  ///< sums of fives of `innovations_`
    Rows pooled_known_;
    Rows agreed_;
    std::vector<PosteriorRows> posteriors_;  ///< of single pixels, then after each step of kAveragedSteps
    PosteriorRows outside_;                  ///< a row without values
    std::vector<std::uint8_t> changes_row_;
    std::vector<std::uint8_t> changes_;
    std::vector<float> doubts_m_;
};

}  // namespace octoskin
