#include "host/io/openni2/helpers/oni_records.hpp"

#include <array>

namespace octoskin::openni2 {
namespace {

enum Word : std::size_t { magic = 0, type = 1, node = 2, fields_size = 3, payload_size = 4 };

}  // namespace

OniRecords::OniRecords(const std::filesystem::path& oni) : file_(oni, std::ios::binary) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(oni, error);
    size_ = error ? 0 : size;
}

std::optional<OniRecord> OniRecords::next() {
    std::array<std::uint32_t, kOniRecordHeaderSize / 4> header{};
    file_.clear();
    const bool is_read = position_ < size_ && file_.seekg(static_cast<std::streamoff>(position_)) &&
                         file_.read(reinterpret_cast<char*>(header.data()), sizeof(header));
    if (!is_read) return std::nullopt;
    const std::uintmax_t end = position_ + header[fields_size] + header[payload_size];
    if (header[magic] != kOniRecordMagic || header[fields_size] < kOniRecordHeaderSize || end > size_)
        return std::nullopt;
    const OniRecord record{OniRecordType{header[type]}, header[node], header[fields_size], position_, end};
    position_ = end;
    return record;
}

}  // namespace octoskin::openni2
