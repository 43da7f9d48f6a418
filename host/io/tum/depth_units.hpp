// Checks whether the scale of a data set's images is plausible. Millimetres read at 5000 a metre make a map
// five times too small.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw/rigfile/data_set_depth.hpp"

namespace octoskin::tum {

/// A histogram of pixel values.
class PixelValues {
  public:
    PixelValues() : counts_(kValues, 0) {}

    /// Adds one image. About 0.5 ms for 640 x 480.
    void add(std::span<const std::uint16_t> values) noexcept {
        for (const std::uint16_t value : values) ++counts_[value];
    }
    [[nodiscard]] std::uint64_t count(std::uint16_t value) const noexcept { return counts_[value]; }

    static constexpr std::size_t kValues = 65536;

  private:
    std::vector<std::uint64_t> counts_;
};

/// The evidence against `scale`, with the key that corrects it; empty if there is none. Evidence is that most
/// pixels are nearer than `depth_min_m`. For images at the layout's own 5000 a metre it is also that most
/// values are not multiples of 5 (those of a camera that measures millimetres are), or that hardly any pixel
/// is as far as a metre. It is not a proof: a close-up looks the same.
[[nodiscard]] std::optional<std::string> doubt_units(const PixelValues& values,
                                                     const rig::DataSetDepth& scale, double depth_min_m);

}  // namespace octoskin::tum
