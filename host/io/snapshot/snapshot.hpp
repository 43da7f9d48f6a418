// A map's whole state as bytes and back: what the .ot and .bt of OctoMap have no room for, and all that they
// have. docs/snapshot.md has the format, byte by byte.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/mapping/map_state.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/io/mapfile/byte_sink.hpp"

namespace octoskin {

/// An instant of this machine that a restart of a program outlives, and a restart of the machine does not.
struct BootTime {
    std::array<std::uint8_t, 16> boot{};  ///< which one it is
    Nanoseconds since_boot{0};            ///< CLOCK_BOOTTIME
    friend bool operator==(const BootTime&, const BootTime&) = default;
};

/// What a snapshot belongs to.
struct SnapshotOrigin {
    std::uint32_t mapping_crc32 = 0;              ///< of mapping_text()
    std::uint32_t placement_crc32 = 0;            ///< rig::placement_crc32: where in the map measurements lay
    std::optional<std::uint32_t> map_crc32 = {};  ///< of the .ot saved with it; empty: there is none
    std::optional<BootTime> map_time = {};        ///< when the map's time was what it says; empty: not known
    friend bool operator==(const SnapshotOrigin&, const SnapshotOrigin&) = default;
};

struct Snapshot {
    SnapshotOrigin origin;
    MapState state;
};

enum class SnapshotFault : std::uint8_t {
    no_snapshot,    ///< of anything
    other_version,  ///< of a snapshot
    damaged,        ///< cut off, changed, or never a state of a map
    other_mapping,  ///< it belongs to another configuration, or to voxels of another size
    no_room,        ///< it takes more memory than the configuration allows
};

struct SnapshotError {
    SnapshotFault fault{};
    std::string what;  ///< for a person
};

/// Gives the sink all bytes. Equal states and origins give equal bytes. Memory for a block besides the
/// state's. Throws std::bad_alloc.
void write_snapshot(const MapState& state, const SnapshotOrigin& origin, const ByteSink& sink);
[[nodiscard]] std::string encode_snapshot(const MapState& state, const SnapshotOrigin& origin);

/// Of any bytes. `mapping_crc32`: of mapping_text(mapping), which the snapshot must belong to. Its map is
/// bit for bit the one that was written, but for its counters and memory. Throws std::bad_alloc.
[[nodiscard]] Result<Snapshot, SnapshotError> decode_snapshot(std::string_view bytes,
                                                              const MappingConfig& mapping,
                                                              std::uint32_t mapping_crc32);

/// What it belongs to, by its first bytes (kSnapshotHeadMax are enough); empty if they are not of a snapshot.
[[nodiscard]] std::optional<SnapshotOrigin> origin_of_snapshot(std::string_view bytes);
inline constexpr std::size_t kSnapshotHeadMax = 256;

}  // namespace octoskin
