// Recovers the complete frames of an .oni file that was cut off, by adding the end that OpenNI2 requires to
// open a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octoskin::openni2 {

/// Size limit of the complete frames: the copy may be in memory.
inline constexpr std::uintmax_t kSalvageMax = std::uintmax_t{4} << 30U;

/// Writes to `copy` the content of `oni` up to its last complete frame, then the end that its recorder would
/// have written: for each stream a removal record and a seek table, then the end record. Each stream's first
/// record gets the position of its table and its number of frames.
/// Returns the number of frames in it, of all streams. Empty if there are none, there are more streams than a
/// device has, the frames exceed kSalvageMax, or the copy cannot be written. Stops at a record that exceeds
/// OpenNI2's buffers. O(size).
[[nodiscard]] std::optional<std::uint32_t> salvage(const std::filesystem::path& oni,
                                                   const std::filesystem::path& copy);

}  // namespace octoskin::openni2
