// Writes an MCAP file: chunks of about a MiB compressed with zstd, their indexes, and a summary, with all
// checksums.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/time.hpp"
#include "host/io/mapfile/byte_sink.hpp"
#include "host/io/mcap/records.hpp"

namespace octoskin::mcap {

class McapWriter {
  public:
    static constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;

    /// `sink` gets the bytes of the file in order. `library`: which program writes it.
    McapWriter(ByteSink sink, std::string_view library);

    /// The id of a new channel. At most 65,535 (asserted). Channels with one schema share it. A channel
    /// without a message is not in the file.
    [[nodiscard]] std::uint16_t add_channel(const Schema& schema, Channel channel);
    /// Messages may come in any order of their times; readers are faster if they come in about that order.
    /// `when`: at least 0 (asserted). False: the sink has failed. Throws std::bad_alloc. About 100 MB/s.
    [[nodiscard]] bool write(std::uint16_t channel, WallTime when, std::string_view data);
    /// Ends the file: without it there is no summary. False: the sink has failed.
    [[nodiscard]] bool finish();

    [[nodiscard]] std::uint64_t messages() const noexcept { return messages_; }
    [[nodiscard]] std::uint64_t bytes() const noexcept { return at_; }

  private:
    struct Span {
        WallTime first{};
        WallTime last{};
        bool has_any = false;
        void add(WallTime time);
    };
    struct ChunkPlace {
        Span times;
        std::uint64_t at = 0;
        std::uint64_t bytes = 0;
        std::map<std::uint16_t, std::uint64_t> indexes;  ///< place of the message index of each channel
        std::uint64_t index_bytes = 0;
        std::uint64_t packed_bytes = 0;
        std::uint64_t unpacked_bytes = 0;
    };
    struct ChannelState {
        Channel channel;
        std::uint64_t messages = 0;
        bool is_written = false;
    };
    using Index = std::vector<std::pair<WallTime, std::uint64_t>>;  ///< time and place in the chunk

    void emit(std::string_view bytes);
    void emit_record(Op op, std::string_view fields);
    void declare(std::uint16_t channel);
    void end_chunk();
    void emit_indexes(ChunkPlace& place);
    void emit_summary();
    [[nodiscard]] std::string schemas() const;
    [[nodiscard]] std::string channels() const;
    [[nodiscard]] std::string statistics() const;
    [[nodiscard]] std::string chunk_indexes() const;

    ByteSink sink_;
    bool has_failed_ = false;
    std::uint64_t at_ = 0;
    std::uint32_t crc_ = 0;        ///< of all bytes so far; of the summary, from its beginning
    std::vector<Schema> schemas_;  ///< id - 1
    std::vector<bool> is_schema_written_;
    std::vector<ChannelState> channels_;  ///< id - 1
    std::string chunk_;
    Span chunk_times_;
    std::map<std::uint16_t, Index> chunk_index_;
    std::vector<ChunkPlace> places_;
    std::uint64_t messages_ = 0;
    Span times_;
};

}  // namespace octoskin::mcap
