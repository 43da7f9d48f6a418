// The memory of each depth camera as records: its name (count, bytes), size and pose, then row by row the
// pixels that have a value:
//
//     until the row ends            pixels without a value; then, unless the row ends, pixels with one
//     (counts)
//       mean, drift, count          floats; the count, times four, plus 2 if a value is held back, plus 1 if
//                                   the pixel has an end
//       key x, y, z; depth          of the end, if there is one: 16 bits each, float
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "host/core/mapping/camera_memory.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/snapshot/blocks.hpp"

namespace octoskin::snapshot {

/// Of one pixel with a value.
inline constexpr std::uint64_t kPixelBytesMax = 21;
/// Bytes of the longest name of a camera in a rig file.
inline constexpr std::uint64_t kCameraNameMax = 32;
/// Pixels of the largest camera of a rig file.
inline constexpr std::uint64_t kCameraPixelsMax = std::uint64_t{4096} * 4096;

/// A pixel without a value must be as constructed (asserted). Throws std::bad_alloc.
void put_camera(BlockWriter& blocks, const CameraMemory& memory);

/// Reads the content of blocks of BlockKind::camera.
class CameraTaker {
  public:
    /// `mapping` must outlive it.
    explicit CameraTaker(const MappingConfig& mapping) noexcept : mapping_(mapping) {}

    /// Malformed: the content is not the memory of cameras with this mapping and unique names. No room: the
    /// cameras' memory would be larger than the mapping allows the map. Throws std::bad_alloc.
    [[nodiscard]] BlockRead take(std::string_view payload);
    /// True without any block, and after the last row of a camera.
    [[nodiscard]] bool is_complete() const noexcept;
    /// Moves them out, after the last block.
    [[nodiscard]] std::vector<CameraMemory> memories() noexcept { return std::move(memories_); }

  private:
    [[nodiscard]] BlockRead take_head(ByteReader& reader);
    [[nodiscard]] bool is_new(const CameraMemory& memory) const noexcept;
    [[nodiscard]] bool take_row(ByteReader& reader);
    [[nodiscard]] CameraMemory::Pixel take_pixel(ByteReader& reader) const;
    [[nodiscard]] bool is_within_limit() const noexcept;
    [[nodiscard]] bool is_possible(const DepthDenoiser::Pixel& depth) const noexcept;

    const MappingConfig& mapping_;
    std::vector<CameraMemory> memories_;  ///< of the last one maybe not all rows
};

}  // namespace octoskin::snapshot
