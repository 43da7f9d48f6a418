// The checksum of files on a disk.
#pragma once

#include <cstdint>
#include <string_view>

namespace octoskin {

/// The same CRC-32 as crc32() of common/wire, computed by zlib: a table of sixteen entries is too slow for
/// megabytes. Continues from `before`, the checksum of the preceding bytes; 0 is that of none.
[[nodiscard]] std::uint32_t file_checksum(std::string_view bytes, std::uint32_t before = 0) noexcept;

}  // namespace octoskin
