// A source file with its path and checksum, so that another file is not taken for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "host/io/folder/file_place.hpp"

namespace octoskin {

struct SourceFile {
    std::filesystem::path file;          ///< absolute on the machine that read it; empty: there was none
    std::optional<std::uint32_t> crc32;  ///< of its bytes; unknown for recordings before 0.1.1
};

/// Called with the number of bytes read so far.
using BytesReport = std::function<void(std::uint64_t bytes)>;

/// CRC-32 (zlib's) of the files' bytes in sequence; empty if one cannot be read. About 400 MB a second.
[[nodiscard]] std::optional<std::uint32_t> crc32_of(std::span<const FilePlace> files,
                                                    const BytesReport& report = {});
[[nodiscard]] std::optional<std::uint32_t> crc32_of(const FilePlace& file);

/// `file` as an absolute path, with the CRC-32 of its bytes and of the `further` files that it includes.
[[nodiscard]] SourceFile source_file(const FilePlace& file, std::span<const FilePlace> further = {});

/// "0x0123abcd".
[[nodiscard]] std::string crc_text(std::uint32_t crc);

}  // namespace octoskin
