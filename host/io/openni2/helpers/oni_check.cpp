#include "host/io/openni2/helpers/oni_check.hpp"

#include <array>
#include <cstring>
#include <vector>

#include "host/io/openni2/helpers/oni_fields.hpp"
#include "host/io/openni2/helpers/oni_records.hpp"
#include "host/io/openni2/helpers/oni_streams.hpp"

namespace octoskin::openni2 {
namespace {

/// The player takes the number of streams from its file header, and its recursion depth grows with the
/// streams.
constexpr std::uint32_t kStreamNumbersMax = 32;

/// Returns the header, or its fault.
Result<OniStreams::Header, std::string> header_of(std::ifstream& file) {
    constexpr std::array<char, 12> kBegin{'N', 'I', '1', '0', 1, 0, 1, 0, 0, 0, 0, 0};  // 1.0.1.0
    std::array<char, kOniFileHeaderSize> header{};
    file.clear();
    file.seekg(0);
    if (!file.read(header.data(), header.size()) ||
        std::memcmp(header.data(), kBegin.data(), kBegin.size()) != 0)
        return unexpected(std::string("not the beginning of an OpenNI 2 recording (NI10, version 1.0.1.0)"));
    std::uint64_t timestamp_max = 0;
    std::uint32_t last = 0;
    std::memcpy(&timestamp_max, header.data() + kBegin.size(), sizeof(timestamp_max));
    std::memcpy(&last, header.data() + kBegin.size() + sizeof(timestamp_max), sizeof(last));
    if (last >= kStreamNumbersMax)
        return unexpected("streams numbered up to " + std::to_string(last) + ", not up to " +
                          std::to_string(kStreamNumbersMax - 1));
    return OniStreams::Header{last + 1, timestamp_max};
}

class Reading {
  public:
    /// Reads fields and payload; false if they exceed the player's buffers, or cannot be read.
    bool read(std::ifstream& file, const OniRecord& record) {
        if (!record.fits()) return false;
        fields_ = record.fields_size - kOniRecordHeaderSize;
        bytes_.resize(fields_ + static_cast<std::size_t>(record.payload_size()));
        file.clear();
        file.seekg(static_cast<std::streamoff>(record.position + kOniRecordHeaderSize));
        file.read(reinterpret_cast<char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
        return static_cast<bool>(file);
    }
    [[nodiscard]] OniBytes fields() const { return OniBytes(bytes_).first(fields_); }
    [[nodiscard]] OniBytes payload() const { return OniBytes(bytes_).subspan(fields_); }

  private:
    std::vector<std::uint8_t> bytes_;
    std::size_t fields_ = 0;
};

}  // namespace

std::optional<OniFault> fault_of(const std::filesystem::path& oni, const std::function<void()>& is_alive) {
    OniRecords records(oni);
    const auto header = header_of(records.file());
    if (!header) return OniFault{0, header.error()};
    OniStreams streams(*header);
    Reading reading;
    while (const auto record = records.next()) {
        if (is_alive) is_alive();
        if (!reading.read(records.file(), *record))
            return OniFault{record->position, "a record that exceeds OpenNI2's buffers"};
        const bool is_end = record->type == OniRecordType::end;
        // The player does not read beyond the end record.
        const auto verdict =
            is_end ? streams.at_end() : streams.take(*record, reading.fields(), reading.payload());
        if (!verdict) return OniFault{record->position, verdict.error()};
        if (is_end) return std::nullopt;
    }
    return OniFault{records.position(), "no complete record, and no end record before it"};
}

}  // namespace octoskin::openni2
