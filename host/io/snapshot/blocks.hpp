// A file of blocks. Each has its kind, number and length, and a checksum of these and of its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "host/io/mapfile/byte_sink.hpp"
#include "host/io/snapshot/bytes.hpp"

namespace octoskin::snapshot {

/// The beginning of the file: 16 bytes, the last of which is the version.
inline constexpr std::string_view kMagic = "octoskin-state/3";
/// Limit of a block's bytes. The record of a brick has at most 2.1 kB, that of a row of a camera 86 kB, that
/// of a zone's readings far less than this limit.
inline constexpr std::size_t kPayloadMax = std::size_t{16} << 20U;

/// In their order in a file.
enum class BlockKind : std::uint8_t {
    head,
    log_odds,
    prior,
    misses,
    hits,
    ages,
    confirmed,
    seen,
    camera,
    done
};
inline constexpr std::size_t kBlockKinds = 10;
/// Four characters.
[[nodiscard]] std::string_view tag_of(BlockKind kind) noexcept;

/// Collects records into blocks and passes these to a sink.
class BlockWriter {
  public:
    /// Writes the beginning of the file.
    explicit BlockWriter(const ByteSink& sink) : sink_(sink) { is_taken_ = sink_(kMagic); }

    /// Appends a record, written by put(writer, is_first), to a block of its kind; `is_first`: the record is
    /// the first of its block. Throws std::bad_alloc.
    template <class Put>
    void add(BlockKind kind, const Put& put) {
        constexpr std::size_t kFull = std::size_t{64} << 10U;
        if (!is_taken_) return;
        if (kind != kind_ || payload_.size() >= kFull) end_block();
        kind_ = kind;
        ByteWriter writer(payload_);
        put(writer, payload_.empty());
    }
    /// Must be called after the last record.
    void finish() { end_block(); }

  private:
    void end_block();

    const ByteSink& sink_;
    bool is_taken_ = true;
    BlockKind kind_ = BlockKind::head;
    std::uint32_t number_ = 0;
    std::string payload_;
};

struct Block {
    BlockKind kind = BlockKind::head;
    std::string_view payload;
    std::size_t at = 0;  ///< position of its first byte in the file
};

/// What became of the content of a block.
enum class BlockRead : std::uint8_t { all, malformed, no_room };

/// Reads blocks from a file's bytes; each is checked before it is returned.
class BlockReader {
  public:
    explicit BlockReader(std::string_view bytes) noexcept : bytes_(bytes), at_(kMagic.size()) {}

    /// Whether the bytes begin like a file of this version; only then may `next` be called.
    [[nodiscard]] bool has_magic() const noexcept { return bytes_.starts_with(kMagic); }
    /// The next block; empty if there is no complete, undamaged block of a kind that is valid at this place.
    [[nodiscard]] std::optional<Block> next() noexcept;
    [[nodiscard]] bool is_over() const noexcept { return at_ == bytes_.size(); }
    [[nodiscard]] std::size_t at() const noexcept { return at_; }

  private:
    std::string_view bytes_;
    std::size_t at_;
    std::uint32_t number_ = 0;
    BlockKind kind_ = BlockKind::head;
};

}  // namespace octoskin::snapshot
