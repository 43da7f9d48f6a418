// The checksum of what lies on a disk.
#pragma once

#include <cstdint>
#include <string_view>

namespace octoskin {

/// As crc32() of common/wire, by zlib: megabytes of a map are no matter of a sixteen-entry table. Continues
/// from the checksum of the bytes before; 0 is that of none.
[[nodiscard]] std::uint32_t file_checksum(std::string_view bytes, std::uint32_t before = 0) noexcept;

}  // namespace octoskin
