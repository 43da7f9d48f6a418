// Decodes the compressed depth frames of an .oni file without OpenNI2, whose decoders check neither the end
// of their input nor their table indices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace octoskin::openni2 {

enum class DepthPacking : std::uint8_t {
    plain,       ///< codec "16zP": differences of depths
    with_table,  ///< codec "16zT": differences of indices into a table of depths, which comes first
};

/// The number of depths that OpenNI2 2.2 decodes from `packed`, by the same steps. Empty if it would read
/// beyond the end, or use an index outside the table. O(size); safe for any bytes.
[[nodiscard]] std::optional<std::size_t> depths_in(std::span<const std::uint8_t> packed,
                                                   DepthPacking packing);

}  // namespace octoskin::openni2
