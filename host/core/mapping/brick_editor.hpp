// The only writer of a map's bricks: opens them if there is room, counts refusals, clamps, and sets time
// stamps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>

#include "common/result.hpp"
#include "host/core/mapping/map_config.hpp"
#include "host/core/mapping/map_counters.hpp"
#include "host/core/mapping/map_layers.hpp"
#include "host/core/mapping/voxel_rules.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Serves one change of a map; TermWriter, ImageWriter and CountWriter use it to apply evidence. Holds
/// references to its constructor's arguments.
class BrickEditor {
  public:
    BrickEditor(MapLayers& layers, const VoxelRules& rules, const MapConfig& config,
                MapCounters& counters) noexcept
        : layers_(layers), rules_(rules), config_(config), counters_(counters) {}

    [[nodiscard]] MapLayers& layers() noexcept { return layers_; }
    [[nodiscard]] const VoxelRules& rules() const noexcept { return rules_; }
    [[nodiscard]] bool has_counts(MortonCode brick) const noexcept {
        return !layers_.counts.empty() && layers_.counts.has(brick);
    }
    [[nodiscard]] bool is_occupied(MortonCode brick, std::size_t cell) const noexcept {
        return rules_.is_occupied(layers_.log_odds.find(brick).at(cell));
    }

    /// Calls `write` to write a brick of the log-odds, unless there is no room or no memory for it. Room is
    /// computed as if each of its voxels had its own value, because each may get one.
    template <class Write>
    [[nodiscard]] Status<MapRefusal> change(MortonCode brick, Write&& write) noexcept {
        if (layers_.log_odds.find(brick).is_unknown() && !has_room_for(brick))
            return unexpected(&MapCounters::no_room);
        try {
            write();
            return Done{};
        } catch (const std::bad_alloc&) {
            return unexpected(&MapCounters::no_memory);
        }
    }
    /// Begins counting in a brick if it has no counts yet, and makes its counts writable.
    [[nodiscard]] Status<MapRefusal> open_counts(MortonCode brick) noexcept;
    /// Counts the result for `voxels` voxels.
    void note(const Status<MapRefusal>& done, std::size_t voxels) noexcept {
        counters_.*(done ? &MapCounters::applied : done.error()) += voxels;
    }
    void note(std::uint64_t MapCounters::*counter, std::size_t voxels = 1) noexcept {
        counters_.*counter += voxels;
    }
    [[nodiscard]] const MapCounters& counters() const noexcept { return counters_; }
    /// Writes a voxel of an open brick. `log_odds` may be a NaN only if the voxel is one.
    void set(float& voxel, float log_odds) noexcept {
        layers_.known_voxels += std::isnan(voxel) && !std::isnan(log_odds) ? 1U : 0U;
        voxel = log_odds;
    }

    /// Records that sensors of this kind measured these voxels now. Does nothing if the map has no clock, for
    /// unknown voxels that never expire, and if there is no room (counted).
    void date(MortonCode brick, const BrickMask& voxels, SensorKind kind) noexcept;
    /// True if the time stamp shows a camera in this second or the one before.
    [[nodiscard]] bool is_seen_by_camera(std::uint16_t stamp) const noexcept;

    /// Gives a time stamp to voxels without one that are known or, if they can expire, have counts: measured
    /// before the clock began. Throws std::bad_alloc.
    void date_all();
    /// Makes unknown all voxels that were last seen longer ago than AgeModel::unknown_after_s. Throws
    /// std::bad_alloc; the next call finds the remaining ones.
    void expire();
    /// Sets every voxel of a cube to this value, clamped. False if there was no room; part of the cube may
    /// then be set. The map must have no counts (asserted). Throws std::bad_alloc.
    [[nodiscard]] bool fill(const VoxelCube& cube, float log_odds);
    /// Clamps all log-odds. Throws std::bad_alloc.
    void clamp_all();
    /// Recomputes the log-odds of each voxel with counts by the rules. Throws std::bad_alloc.
    void fuse_all();

  private:
    [[nodiscard]] std::size_t bytes_max() const noexcept {
        return std::size_t{config_.memory_max_mib} << 20U;
    }
    [[nodiscard]] bool has_room_for(MortonCode brick) const noexcept;
    [[nodiscard]] bool has_room_to_count(MortonCode brick) const noexcept;
    [[nodiscard]] bool has_room_to_date(MortonCode brick) const noexcept;
    void fuse(MortonCode brick);
    /// Voxels that are known or have counts.
    [[nodiscard]] BrickMask measured_in(MortonCode brick) const noexcept;
    void expire_log_odds(MortonCode brick, const BrickMask& voxels);

    MapLayers& layers_;
    const VoxelRules& rules_;
    const MapConfig& config_;
    MapCounters& counters_;
};

/// Number of known voxels that expire if `passed_s` more seconds pass, for an AgeModel::unknown_after_s above
/// 0. Memory is not needed. About 0.1 us for each brick with time stamps.
[[nodiscard]] std::size_t count_due(const MapLayers& layers, std::uint32_t unknown_after_s,
                                    std::int64_t passed_s);

/// The smallest memory limit that these layers comply with, counts with their share of it. Time stamps cover
/// the same space and use the room that is left.
[[nodiscard]] std::size_t bytes_needed(const MapLayers& layers) noexcept;

/// Bytes of a tree if each voxel has its own value.
[[nodiscard]] std::size_t bytes_at_most(const BrickTree& tree) noexcept;

}  // namespace octoskin
