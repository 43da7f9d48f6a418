// The records of an .oni file one after the other, read without OpenNI2, which opens no file that has no end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>

namespace octoskin::openni2 {

// As OpenNI2 2.2 writes them (Source/Core/OniDataRecords.h): a file header, then records, each with a packed
// header whose `fields_size` counts itself. Little-endian, as all its machines are.
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
    OniRecordType type{};  ///< others than those named are there, too
    std::uint32_t node = 0;
    std::uint32_t fields_size = 0;
    std::uintmax_t position = 0;  ///< of its first byte
    std::uintmax_t end = 0;       ///< of the byte after its last

    [[nodiscard]] std::uintmax_t payload_size() const noexcept { return end - position - fields_size; }
    /// Whether the player has room for it: it reads the fields into a buffer for the largest payload and a
    /// frame's fields.
    [[nodiscard]] bool fits() const noexcept {
        return fields_size - kOniRecordHeaderSize <= kOniFieldsMax && payload_size() <= kOniPayloadMax;
    }
};

class OniRecords {
  public:
    /// A file that is not there has no records.
    explicit OniRecords(const std::filesystem::path& oni);

    /// The next whole record; empty where the file or its sense ends. One small read.
    [[nodiscard]] std::optional<OniRecord> next();
    /// Where next() looks.
    [[nodiscard]] std::uintmax_t position() const noexcept { return position_; }
    /// The file, to read in: next() finds its way by itself.
    [[nodiscard]] std::ifstream& file() noexcept { return file_; }

  private:
    std::ifstream file_;
    std::uintmax_t size_ = 0;
    std::uintmax_t position_ = kOniFileHeaderSize;
};

}  // namespace octoskin::openni2
