// The only way to a map's bricks: opens them where there is room, counts what is refused, clamps, and dates.
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

/// Of a map, for one change of it; TermWriter, ImageWriter and CountWriter use it for evidence. Holds
/// references to what it is made of.
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

    /// Makes `write` write a brick of the log-odds, unless there is no room or no memory for it. Space counts
    /// as if each of its voxels had a value of its own, for each may come to have one.
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
    /// Begins to count in a brick, if that is to be, and gives its counts a place each.
    [[nodiscard]] Status<MapRefusal> open_counts(MortonCode brick) noexcept;
    /// Counts what became of so many voxels.
    void note(const Status<MapRefusal>& done, std::size_t voxels) noexcept {
        counters_.*(done ? &MapCounters::applied : done.error()) += voxels;
    }
    void note(std::uint64_t MapCounters::*counter, std::size_t voxels = 1) noexcept {
        counters_.*counter += voxels;
    }
    [[nodiscard]] const MapCounters& counters() const noexcept { return counters_; }
    /// Writes a voxel of an open brick; a NaN, if it had one.
    void set(float& voxel, float log_odds) noexcept {
        layers_.known_voxels += std::isnan(voxel) && !std::isnan(log_odds) ? 1U : 0U;
        voxel = log_odds;
    }

    /// Sensors of this kind measured these voxels now. Nothing if the map has no clock, for what is unknown
    /// and never expires, and where there is no room (counted).
    void date(MortonCode brick, const BrickMask& voxels, SensorKind kind) noexcept;
    /// In this second or the one before, by its stamp.
    [[nodiscard]] bool is_seen_by_camera(std::uint16_t stamp) const noexcept;

    /// What is known or, if that can expire, counted and has no time: it was there when the clock began, for
    /// all that is known. Throws std::bad_alloc.
    void date_all();
    /// Makes unknown what was last seen before AgeModel::unknown_after_s. Throws std::bad_alloc: what is left
    /// then is found the next time.
    void expire();
    /// Gives every voxel of a cube this value, clamped. False if there was no room; then part of the cube may
    /// be set. There must be no counts (asserted). Throws std::bad_alloc.
    [[nodiscard]] bool fill(const VoxelCube& cube, float log_odds);
    /// Clamps all log-odds. Throws std::bad_alloc.
    void clamp_all();
    /// Makes each voxel with counts what the rules come to. Throws std::bad_alloc.
    void fuse_all();

  private:
    [[nodiscard]] std::size_t bytes_max() const noexcept {
        return std::size_t{config_.memory_max_mib} << 20U;
    }
    [[nodiscard]] bool has_room_for(MortonCode brick) const noexcept;
    [[nodiscard]] bool has_room_to_count(MortonCode brick) const noexcept;
    [[nodiscard]] bool has_room_to_date(MortonCode brick) const noexcept;
    void fuse(MortonCode brick);
    /// Voxels that are known, or counted.
    [[nodiscard]] BrickMask measured_in(MortonCode brick) const noexcept;
    void expire_log_odds(MortonCode brick, const BrickMask& voxels);

    MapLayers& layers_;
    const VoxelRules& rules_;
    const MapConfig& config_;
    MapCounters& counters_;
};

/// The least limit of memory that these layers are within, counts with their share of it. Times are of the
/// same space, and have what room there is.
[[nodiscard]] std::size_t bytes_needed(const MapLayers& layers) noexcept;

/// What a tree takes if each voxel has a value of its own.
[[nodiscard]] std::size_t bytes_at_most(const BrickTree& tree) noexcept;

}  // namespace octoskin
