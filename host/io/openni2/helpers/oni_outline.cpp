#include "host/io/openni2/helpers/oni_outline.hpp"

#include <array>
#include <fstream>

namespace octoskin::openni2 {
namespace {

// As OpenNI2 2.2 writes it (Source/Core/OniDataRecords.h): a file header of 24 bytes, then records with this
// packed header. `fields_size` counts the header too.
constexpr std::uintmax_t kFileHeaderSize = 24;
constexpr std::size_t kRecordHeaderSize = 28;
constexpr std::uint32_t kRecordMagic = 0x0052494E;  // "NIR"
enum Word : std::size_t { magic = 0, type = 1, fields_size = 3, payload_size = 4 };
constexpr std::uint32_t kDataBegin = 0x08;
constexpr std::uint32_t kNewData = 0x0A;
constexpr std::uint32_t kEnd = 0x0B;

}  // namespace

OniOutline outline_of(const std::filesystem::path& oni) {
    OniOutline outline;
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(oni, error);
    std::ifstream file(oni, std::ios::binary);
    std::uintmax_t position = kFileHeaderSize;
    std::array<std::uint32_t, kRecordHeaderSize / 4> header{};
    while (!error && file.seekg(static_cast<std::streamoff>(position)) &&
           file.read(reinterpret_cast<char*>(header.data()), sizeof(header))) {
        position += std::uintmax_t{header[fields_size]} + header[payload_size];
        if (header[magic] != kRecordMagic || header[fields_size] < kRecordHeaderSize || position > size)
            break;
        if (header[type] == kDataBegin) outline.has_begun = true;
        if (header[type] == kNewData) ++outline.frames;
        if (header[type] == kEnd) {
            outline.length = position;
            break;
        }
    }
    return outline;
}

}  // namespace octoskin::openni2
