// The compressed depth frames of an .oni file, walked without OpenNI2, whose decoders check neither where
// their input ends nor what they look up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace octoskin::openni2 {

enum class DepthPacking : std::uint8_t {
    plain,       ///< codec "16zP": differences of depths
    with_table,  ///< codec "16zT": differences of numbers in a table of depths, which comes first
};

/// How many depths OpenNI2 2.2 makes of `packed`, step for step as it does; empty if it read beyond the end,
/// or looked up what is not in the table. O(size); any bytes are safe.
[[nodiscard]] std::optional<std::size_t> depths_in(std::span<const std::uint8_t> packed,
                                                   DepthPacking packing);

}  // namespace octoskin::openni2
