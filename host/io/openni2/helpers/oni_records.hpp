// Reads the records of an .oni file in order without OpenNI2, which cannot open a file without an end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

namespace octoskin::openni2 {

// The format of OpenNI2 2.2 (Source/Core/OniDataRecords.h): a file header, then records, each with a packed
// header whose `fields_size` includes the header itself. Little-endian, like all platforms of OpenNI2.
inline constexpr std::uintmax_t kOniFileHeaderSize = 24;
inline constexpr std::uint32_t kOniRecordHeaderSize = 28;
inline constexpr std::uint32_t kOniFrameFieldsSize = kOniRecordHeaderSize + 12;  // a time stamp and a number
inline constexpr std::uint32_t kOniFieldsMax = 1U << 20U;
inline constexpr std::uint32_t kOniPayloadMax = 1600 * 1200 * 3;  // PlayerNode::DATA_MAX_SIZE
inline constexpr std::uint32_t kOniRecordMagic = 0x0052494E;      // "NIR"

enum class OniRecordType : std::uint32_t {
    int_property = 0x03,
    real_property = 0x04,
    string_property = 0x05,
    general_property = 0x06,
    node_removed = 0x07,
    data_begin = 0x08,
    state_ready = 0x09,
    new_data = 0x0A,
    end = 0x0B,
    node_added = 0x0D,
    seek_table = 0x0E,
};

struct OniRecord {
    OniRecordType type{};  ///< values other than the named ones occur
    std::uint32_t node = 0;
    std::uint32_t fields_size = 0;
    std::uintmax_t position = 0;  ///< of its first byte
    std::uintmax_t end = 0;       ///< of the byte after its last

    [[nodiscard]] std::uintmax_t payload_size() const noexcept { return end - position - fields_size; }
    /// Whether the record fits the player's buffers: the buffer for fields has room for the largest payload
    /// and a frame's fields.
    [[nodiscard]] bool fits() const noexcept {
        return fields_size - kOniRecordHeaderSize <= kOniFieldsMax && payload_size() <= kOniPayloadMax;
    }
};

class OniRecords {
  public:
    /// A missing file has no records.
    explicit OniRecords(const std::filesystem::path& oni);

    /// The next complete record; empty at the end of the file or at an invalid record. One small read.
    [[nodiscard]] std::optional<OniRecord> next();
    /// The position at which next() reads.
    [[nodiscard]] std::uintmax_t position() const noexcept { return position_; }
    /// The file, for reading; next() restores its own position.
    [[nodiscard]] std::ifstream& file() noexcept { return file_; }

  private:
    std::ifstream file_;
    std::uintmax_t size_ = 0;
    std::uintmax_t position_ = kOniFileHeaderSize;
};

}  // namespace octoskin::openni2
