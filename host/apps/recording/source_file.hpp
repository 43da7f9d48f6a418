// A file that something was made from: its path and what was in it, so that another file is not taken for it.
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
    std::filesystem::path file;          ///< absolute where it was read; empty: there was none
    std::optional<std::uint32_t> crc32;  ///< of its bytes; of recordings before 0.1.1 it is not known
};

/// Is told of the bytes that are read so far.
using BytesReport = std::function<void(std::uint64_t bytes)>;

/// CRC-32 (zlib's) of the files' bytes, one after the other; empty if one cannot be read. Some 400 MB a
/// second.
[[nodiscard]] std::optional<std::uint32_t> crc32_of(std::span<const FilePlace> files,
                                                    const BytesReport& report = {});
[[nodiscard]] std::optional<std::uint32_t> crc32_of(const FilePlace& file);

/// `file` made absolute, with its CRC-32, and that of the `further` files that it brings in.
[[nodiscard]] SourceFile source_file(const FilePlace& file, std::span<const FilePlace> further = {});

/// "0x0123abcd".
[[nodiscard]] std::string crc_text(std::uint32_t crc);

}  // namespace octoskin
