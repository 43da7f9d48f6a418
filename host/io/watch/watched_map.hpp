// The reader's side of `watch`: the daemon's map, put together from its frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/map_layers.hpp"
#include "host/core/mapping/voxel_rules.hpp"
#include "host/core/voxels/voxel_lattice.hpp"
#include "host/io/snapshot/bytes.hpp"
#include "host/io/watch/watch_frame.hpp"

namespace octoskin::watch {

class WatchedMap {
  public:
    /// `bytes_max`: limit of the heap memory, computed as if each voxel had a value of its own.
    explicit WatchedMap(std::size_t bytes_max = std::size_t{2} << 30U) noexcept : bytes_max_(bytes_max) {}

    enum class Taken : std::uint8_t { all, malformed, no_room };
    /// Applies a frame of FrameKind::map. Malformed: its bytes are no map's, or it continues a map that has
    /// not begun or has another resolution; what was applied of it stays. Safe for any bytes. Throws
    /// std::bad_alloc.
    [[nodiscard]] Taken take(const FrameHeader& header, std::string_view payload);

    /// True from the first complete map on, until another one begins. Between complete maps some bricks are
    /// newer than others.
    [[nodiscard]] bool is_whole() const noexcept { return is_whole_; }
    /// True if the newest frame made it the complete map of `time`.
    [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }
    [[nodiscard]] HostTime time() const noexcept { return time_; }
    [[nodiscard]] double resolution_m() const noexcept { return head_.resolution_m; }
    /// Log-odds from which a voxel is occupied.
    [[nodiscard]] float occupied_from() const noexcept { return head_.occupied_from; }

    [[nodiscard]] Occupancy occupancy(VoxelKey key) const noexcept;
    /// When and by which kind of sensor a known voxel was last seen; empty if unknown.
    [[nodiscard]] std::optional<Confirmation> confirmation(VoxelKey key) const noexcept;
    /// For a known voxel: no sensor has seen it for the mapping's `stale_after_s`.
    [[nodiscard]] bool is_stale(VoxelKey key) const noexcept;
    /// A map of these voxels and ages, without counts; the same voxels are stale. Its clamps are wide enough
    /// for every value. It shares the bricks. O(1). Needs a whole map (asserted).
    [[nodiscard]] FusedMap map() const;
    [[nodiscard]] const BrickTree& log_odds() const noexcept { return log_odds_; }
    [[nodiscard]] const StampTree& stamps() const noexcept { return stamps_; }

  private:
    struct Head {
        double resolution_m = 0.0;
        float occupied_from = 0.0F;
        bool has_begun = false;
        std::uint32_t clock = 0;
        std::uint16_t stale_stamp = 0;
    };
    [[nodiscard]] bool take_head(snapshot::ByteReader& reader, bool begins);
    [[nodiscard]] bool take_brick(snapshot::ByteReader& reader);
    [[nodiscard]] std::uint32_t stale_after_s() const noexcept;
    void widen_clamps(const BrickView& brick);
    [[nodiscard]] std::size_t bytes() const noexcept;

    std::size_t bytes_max_;
    Head head_;
    BrickTree log_odds_;
    StampTree stamps_;
    std::size_t known_voxels_ = 0;
    float lowest_ = 0.0F;  ///< no voxel is below it
    float highest_ = 0.0F;
    HostTime time_{0};
    bool has_begun_ = false;
    bool is_whole_ = false;
    bool is_complete_ = false;
};

}  // namespace octoskin::watch
