// Compression of the chunks of an MCAP file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"

namespace octoskin::mcap {

enum class Compression : std::uint8_t { none, lz4, zstd };

/// As a chunk names it: "", "lz4", "zstd".
[[nodiscard]] std::string_view name_of(Compression compression) noexcept;
/// Empty: not one of them.
[[nodiscard]] std::optional<Compression> compression_of(std::string_view name) noexcept;

/// One frame of zstd. About 200 MB/s. Throws std::bad_alloc.
[[nodiscard]] std::string compress_zstd(std::string_view bytes);

/// False if `packed` does not give exactly `size` bytes. `bytes` then has no meaning. Memory: `size`, which
/// the caller bounds. Safe for any bytes. Throws std::bad_alloc.
[[nodiscard]] bool decompress(Compression compression, std::string_view packed, std::size_t size,
                              std::string& bytes);

}  // namespace octoskin::mcap
