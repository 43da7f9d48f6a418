// A file of blocks, each with its kind, its number, its length and a checksum of all of these and of its
// bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "host/io/mapfile/byte_sink.hpp"
#include "host/io/snapshot/bytes.hpp"

namespace octoskin::snapshot {

/// What the file begins with: 16 bytes, the last of which is the version.
inline constexpr std::string_view kMagic = "octoskin-state/2";
/// Of a block's bytes. A record of a brick has 2.1 kB at most, one of a zone's readings far less than this.
inline constexpr std::size_t kPayloadMax = std::size_t{16} << 20U;

/// In the order in which they come in a file.
enum class BlockKind : std::uint8_t { head, log_odds, prior, misses, hits, ages, confirmed, seen, done };
inline constexpr std::size_t kBlockKinds = 9;
/// Four characters.
[[nodiscard]] std::string_view tag_of(BlockKind kind) noexcept;

/// Records to blocks to a sink.
class BlockWriter {
  public:
    /// Begins the file.
    explicit BlockWriter(const ByteSink& sink) : sink_(sink) { is_taken_ = sink_(kMagic); }

    /// Appends a record, which put(writer, is_first) writes, to a block of its kind; whether it is the
    /// block's first. Throws std::bad_alloc.
    template <class Put>
    void add(BlockKind kind, const Put& put) {
        constexpr std::size_t kFull = std::size_t{64} << 10U;
        if (!is_taken_) return;
        if (kind != kind_ || payload_.size() >= kFull) end_block();
        kind_ = kind;
        ByteWriter writer(payload_);
        put(writer, payload_.empty());
    }
    /// After the last record.
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
    std::size_t at = 0;  ///< which byte of the file it begins with
};

/// Blocks of a file's bytes, each checked before it is given.
class BlockReader {
  public:
    explicit BlockReader(std::string_view bytes) noexcept : bytes_(bytes), at_(kMagic.size()) {}

    /// Whether they begin as a file of this version; then `next` may be asked.
    [[nodiscard]] bool has_magic() const noexcept { return bytes_.starts_with(kMagic); }
    /// The next one; empty where there is no whole and undamaged one, or a kind that cannot come there.
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
