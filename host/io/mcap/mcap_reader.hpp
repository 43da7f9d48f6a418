// Reads an MCAP file of any writer: with or without indexes, whole or cut off, in chunks or not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <queue>
#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"
#include "host/io/mcap/layout.hpp"
#include "host/io/mcap/records.hpp"

namespace octoskin::mcap {

/// What of a file is not read; each has a counter.
enum class Fault : std::uint8_t {
    cut,            ///< the file ends within a record, or without its end; at most 1
    data_crc,       ///< the checksum of all data is wrong; at most 1. Messages are read nevertheless
    oversized,      ///< a record or chunk of more than 128 MiB
    compression,    ///< a chunk with another compression than lz4 and zstd
    damaged_chunk,  ///< a chunk that cannot be unpacked, or whose checksum is wrong
    bad_record,     ///< a record whose fields do not fit its length, which ends its chunk; a name over 1 KiB
    unknown_channel,  ///< a message of a channel that is not described before it
    out_of_order,     ///< a message that comes after a later one: the chunks overlap by more than 128 MiB
};
[[nodiscard]] constexpr std::array<const char*, 8> names_of(Fault) {
    return {"cut",           "data_crc",   "oversized",       "compression",
            "damaged_chunk", "bad_record", "unknown_channel", "out_of_order"};
}

struct Message {
    MessageHead head;
    const Channel* channel = nullptr;  ///< of the reader
    const Schema* schema = nullptr;    ///< of the reader; null: the channel has none, or it is not described
    std::span<const std::uint8_t> data;
    std::shared_ptr<const std::string> owner;  ///< of the data
};

class McapReader {
  public:
    /// Chunks that overlap in time wait in memory up to this size, and one more.
    static constexpr std::size_t kWaitingBytesMax = std::size_t{128} << 20U;

    /// Errors: those of FilePlace::open and survey().
    [[nodiscard]] static Result<McapReader, Error> open(const FilePlace& file);

    /// The next message in the order of log times; of one time, in the order of the file. Empty at the end.
    /// Errors: system_error. Memory: a
    /// chunk and those that overlap it in time, and up to twice as much again for many small messages. Throws
    /// std::bad_alloc.
    [[nodiscard]] Result<std::optional<Message>, Error> next();

    [[nodiscard]] std::uint64_t count(Fault fault) const noexcept {
        return counts_[static_cast<std::size_t>(fault)];
    }
    /// Bytes of the file in chunks that were read, and of all: for progress.
    [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }
    [[nodiscard]] std::uint64_t bytes_of_data() const noexcept { return layout_.end; }
    /// All channels that were described so far, also by the summary.
    [[nodiscard]] const std::map<std::uint16_t, Channel>& channels() const noexcept { return channels_; }

  private:
    struct Waiting {
        MessageHead head;
        std::uint64_t number = 0;  ///< in the order of the file
        std::string_view data;
        std::shared_ptr<const std::string> owner;
    };
    struct IsLater {
        bool operator()(const Waiting& a, const Waiting& b) const noexcept {
            return a.head.logged != b.head.logged ? a.head.logged > b.head.logged : a.number > b.number;
        }
    };

    McapReader(OpenFile file, Layout layout);
    void note(Fault fault) noexcept { ++counts_[static_cast<std::size_t>(fault)]; }
    [[nodiscard]] bool must_load() const;
    [[nodiscard]] Status<Error> load(const Stretch& stretch);
    void take_chunk(std::string_view fields);
    void take_records(std::string bytes);
    void take_type(Op op, std::string_view fields);
    void take_message(std::string_view fields, const std::shared_ptr<const std::string>& owner);
    [[nodiscard]] std::optional<Message> described(Waiting waiting);

    OpenFile file_;
    Layout layout_;
    std::map<std::uint16_t, Schema> schemas_;
    std::map<std::uint16_t, Channel> channels_;
    std::size_t type_bytes_ = 0;
    std::vector<std::size_t> order_;  ///< of layout_.stretches
    std::size_t next_ = 0;            ///< in order_
    std::priority_queue<Waiting, std::vector<Waiting>, IsLater> waiting_;
    std::shared_ptr<std::size_t> bytes_held_ = std::make_shared<std::size_t>(0);
    std::uint64_t number_ = 0;
    std::uint64_t bytes_read_ = 0;
    WallTime newest_{std::numeric_limits<std::int64_t>::min()};
    std::array<std::uint64_t, 8> counts_{};
};

}  // namespace octoskin::mcap
