// Where the parts of an MCAP file are. Found by going from record to record, so that a file without a
// summary, or with a wrong one, is read like any other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/io/folder/open_file.hpp"
#include "host/io/mcap/records.hpp"

namespace octoskin::mcap {

/// A chunk, or a run of records outside chunks.
struct Stretch {
    std::uint64_t at = 0;     ///< of its first record's head
    std::uint64_t bytes = 0;  ///< with the heads of its records
    bool is_chunk = false;
    bool has_messages = false;
    WallTime first{};  ///< of its messages, as the file states it
};

struct Layout {
    std::vector<Stretch> stretches;  ///< in the order of the file
    /// From the summary.
    std::map<std::uint16_t, Schema> schemas;
    std::map<std::uint16_t, Channel> channels;
    bool is_cut = false;               ///< it ends within a record, or without a footer
    std::uint64_t end = 0;             ///< of the records that are whole
    std::optional<std::uint32_t> crc;  ///< of the bytes before `crc_until`, if the file states it
    std::uint64_t crc_until = 0;
    std::uint64_t oversized = 0;  ///< records of more than kRecordBytesMax, which are left out
};

/// Of one record that is read whole; attachments are not.
inline constexpr std::uint64_t kRecordBytesMax = std::uint64_t{128} << 20U;
/// Of all schemas and channels of a file.
inline constexpr std::size_t kTypesBytesMax = std::size_t{64} << 20U;
inline constexpr std::size_t kStretchesMax = std::size_t{4} << 20U;

/// Reads the heads of all records and the summary. Errors: foreign_format (no MCAP file), limit_exceeded,
/// system_error. A read of some bytes for each record: 0.1 s for each GB in chunks of a MiB.
[[nodiscard]] Result<Layout, Error> survey(const OpenFile& file);

/// All `count` bytes at `at`. Errors: system_error, also if the file has become shorter.
[[nodiscard]] Result<std::string, Error> read_at(const OpenFile& file, std::uint64_t at, std::uint64_t count);

/// Whether the CRC-32 of the data, if the file states it, is right. Reads all of it: 1 s for each GB.
[[nodiscard]] Result<bool, Error> has_right_crc(const OpenFile& file, const Layout& layout);

}  // namespace octoskin::mcap
