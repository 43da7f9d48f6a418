#include "host/io/mapfile/file_checksum.hpp"

#include <zlib.h>

namespace octoskin {

std::uint32_t file_checksum(std::string_view bytes, std::uint32_t before) noexcept {
    const auto* const first = reinterpret_cast<const Bytef*>(bytes.data());
    return static_cast<std::uint32_t>(::crc32_z(before, first, bytes.size()));
}

}  // namespace octoskin
