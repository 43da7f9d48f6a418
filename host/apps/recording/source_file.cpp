#include "host/apps/recording/source_file.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <vector>

#include "host/io/mapfile/file_checksum.hpp"

namespace octoskin {

std::optional<std::uint32_t> crc32_of(std::span<const FilePlace> files, const BytesReport& report) {
    std::uint32_t crc = 0;
    std::uint64_t read = 0;
    std::array<char, 65'536> buffer{};
    for (const auto& file : files) {
        const auto opened = file.open();
        if (!opened) return std::nullopt;
        std::ifstream stream(opened->path_for_libraries(), std::ios::binary);
        if (!stream) return std::nullopt;
        while (stream.read(buffer.data(), buffer.size()), stream.gcount() > 0) {
            crc = file_checksum({buffer.data(), static_cast<std::size_t>(stream.gcount())}, crc);
            read += static_cast<std::uint64_t>(stream.gcount());
            if (report) report(read);
        }
        if (stream.bad()) return std::nullopt;
    }
    return crc;
}

std::optional<std::uint32_t> crc32_of(const FilePlace& file) {
    return crc32_of(std::span(&file, 1));
}

SourceFile source_file(const FilePlace& file, std::span<const FilePlace> further) {
    std::vector<FilePlace> all{file};
    all.insert(all.end(), further.begin(), further.end());
    return {std::filesystem::absolute(file.shown()).lexically_normal(), crc32_of(all)};
}

std::string crc_text(std::uint32_t crc) {
    return fmt::format("0x{:08x}", crc);
}

}  // namespace octoskin
