// The whole frames of an .oni file that was cut off, given the end that OpenNI2 wants before it opens a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octoskin::openni2 {

/// Of the whole frames: the copy may lie in memory.
inline constexpr std::uintmax_t kSalvageMax = std::uintmax_t{4} << 30U;

/// Writes to `copy` what `oni` has up to its last whole frame, then what its recorder would have written at
/// its end: for each stream a removal, a seek table and its place and the number of frames in the stream's
/// first record; then the end. Returns the frames in it, of all streams; empty if there is none, the streams
/// are more than a device has, the frames are more than kSalvageMax, or the copy cannot be written. Ends at
/// what OpenNI2 has no room for. O(size).
[[nodiscard]] std::optional<std::uint32_t> salvage(const std::filesystem::path& oni,
                                                   const std::filesystem::path& copy);

}  // namespace octoskin::openni2
