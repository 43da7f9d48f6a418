// The bricks of a map that a reader lacks, as payloads of `watch`:
//
//     resolution, metres (double); log-odds from which a voxel is occupied (float)
//     the clock of the ages: a flag (has begun) and its reading (32 bits); time stamp below which a known
//     voxel is stale (16 bits)
//     bricks until the end: a count, its number in Morton order (code / 512), then its log-odds and its time
//     stamps, each as a byte and what follows it: 0 nothing is known; 1 one value for all voxels; 2 runs
//     (host/io/snapshot/brick_records.hpp)
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin::watch {

/// Bricks by the code of their first voxel, sorted, each once.
using BrickCodes = std::vector<MortonCode>;

/// Every brick of a map, with log-odds or time stamps.
[[nodiscard]] BrickCodes bricks_of(const FusedMap& map);
/// The bricks in which the log-odds or the time stamps of two copies of one map may differ. O(bricks written
/// between them).
[[nodiscard]] BrickCodes changed_bricks(const FusedMap& now, const FusedMap& before);

/// Bricks of a map as they are in payloads, made once for many readers.
class BrickRecords {
  public:
    BrickRecords() = default;
    /// Those of the first `bricks`, within about kBytesMax. Throws std::bad_alloc. O(bricks).
    BrickRecords(const FusedMap& map, const BrickCodes& bricks);
    /// Empty: it is not among them. O(log bricks).
    [[nodiscard]] std::string_view find(MortonCode brick) const noexcept;

  private:
    static constexpr std::size_t kBytesMax = std::size_t{8} << 20U;
    BrickCodes codes_;
    std::vector<std::size_t> ends_;  ///< of each record in bytes_
    std::string bytes_;
};

/// The bricks that one reader lacks. They go out in turn, beginning behind the one that went out last: with a
/// slow reader, bricks that change all the time do not keep the others from it.
class MissingBricks {
  public:
    /// Throws std::bad_alloc; nothing is changed then. O(both).
    void add(const BrickCodes& bricks);
    [[nodiscard]] bool empty() const noexcept { return codes_.empty(); }
    [[nodiscard]] std::size_t size() const noexcept { return codes_.size(); }
    /// The payload with the next bricks as they are in `map`, of about `bytes_max`, and at least one brick;
    /// these are no longer missing. Without any brick the payload has the beginning only. `made`:
    /// records of `map`. Throws std::bad_alloc.
    [[nodiscard]] std::string take(const FusedMap& map, std::size_t bytes_max, const BrickRecords& made = {});

  private:
    BrickCodes codes_;
    MortonCode next_ = 0;
};

/// What one reader lacks of a map that changes: the whole map first, then the bricks that changed, however
/// slowly it reads.
class MapReader {
  public:
    /// Another map is there; `changed`: against the one before. The first time, all of its bricks are
    /// missing.
    void on_map(const FusedMap& now, const BrickCodes& changed);
    /// The next map has nothing to do with those before.
    void begin_again() { *this = MapReader(); }
    /// No piece goes out before another map is there. What the reader lacks, it still lacks then.
    void wait_for_next() noexcept { is_behind_ = false; }

    struct Piece {
        std::uint8_t flags = 0;  ///< kBegins, kComplete (watch_frame.hpp)
        std::string payload;
    };
    /// The next piece of `now`, of about `bytes_max`; empty: the reader has all of the newest map. `made`:
    /// records of `now`. Throws std::bad_alloc.
    [[nodiscard]] std::optional<Piece> next(const FusedMap& now, std::size_t bytes_max,
                                            const BrickRecords& made = {});

  private:
    MissingBricks missing_;
    bool has_map_ = false;    ///< it was given one
    bool has_begun_ = false;  ///< the first piece of a map was made
    bool is_behind_ = false;  ///< the newest map was not completed
};

}  // namespace octoskin::watch
