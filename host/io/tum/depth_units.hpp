// Whether the values of a data set's images are what the rig takes them for. Millimetres read as 5000 a metre
// make a map five times too small.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hw/rigfile/data_set_depth.hpp"

namespace octoskin::tum {

/// How often each value of a pixel was read.
class PixelValues {
  public:
    PixelValues() : counts_(kValues, 0) {}

    /// One image. About 0.5 ms for 640 x 480.
    void add(std::span<const std::uint16_t> values) noexcept {
        for (const std::uint16_t value : values) ++counts_[value];
    }
    [[nodiscard]] std::uint64_t count(std::uint16_t value) const noexcept { return counts_[value]; }

    static constexpr std::size_t kValues = 65536;

  private:
    std::vector<std::uint64_t> counts_;
};

/// What speaks against `scale`, with the key that mends it: most pixels are nearer than `depth_min_m`; or, of
/// an image that is read in the layout's own 5000 a metre, most values are no multiple of 5, which those of a
/// camera that measures millimetres are, or no pixel to speak of is as far as a metre. Empty if nothing does.
/// It is a doubt: a close-up looks alike.
[[nodiscard]] std::optional<std::string> doubt_units(const PixelValues& values,
                                                     const rig::DataSetDepth& scale, double depth_min_m);

}  // namespace octoskin::tum
