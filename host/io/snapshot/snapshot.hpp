// A map's whole state as bytes and back: what the .ot and .bt of OctoMap have no room for, and all that they
// have. docs/reference/map-files.md has the format, byte by byte.
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
#include "host/errors/error.hpp"
#include "host/io/mapfile/byte_sink.hpp"

namespace octoskin {

/// A time on this machine that stays valid across restarts of a program, but not of the machine.
struct BootTime {
    std::array<std::uint8_t, 16> boot{};  ///< identifies the boot
    Nanoseconds since_boot{0};            ///< CLOCK_BOOTTIME
    friend bool operator==(const BootTime&, const BootTime&) = default;
};

/// The configuration, placement, map and time to which a snapshot belongs.
struct SnapshotOrigin {
    std::uint32_t mapping_crc32 = 0;              ///< of mapping_text()
    std::uint32_t placement_crc32 = 0;            ///< rig::placement_crc32: where measurements are in the map
    std::optional<std::uint32_t> map_crc32 = {};  ///< of the .ot saved with it; empty: there is none
    std::optional<BootTime> map_time = {};        ///< the instant of the map's time; empty: unknown
    friend bool operator==(const SnapshotOrigin&, const SnapshotOrigin&) = default;
};

struct Snapshot {
    SnapshotOrigin origin;
    MapState state;
};

/// Passes all bytes to the sink. Equal states and origins give equal bytes. Needs memory for one block
/// besides the state. Throws std::bad_alloc.
void write_snapshot(const MapState& state, const SnapshotOrigin& origin, const ByteSink& sink);
[[nodiscard]] std::string encode_snapshot(const MapState& state, const SnapshotOrigin& origin);

/// Decodes any bytes. Errors, without file: ErrorCode::foreign_format (not a snapshot), unsupported
/// (another version), damaged (cut off, changed, or not a possible state of a map), mismatch (another
/// configuration or voxel size), too_large (more memory than the configuration allows). `mapping_crc32`: of
/// mapping_text(mapping), to which the snapshot must belong. The map equals the written one bit for bit,
/// except for its counters and memory. Throws std::bad_alloc.
[[nodiscard]] Result<Snapshot, Error> decode_snapshot(std::string_view bytes, const MappingConfig& mapping,
                                                      std::uint32_t mapping_crc32);

/// The origin, from the first bytes (kSnapshotHeadMax are enough); empty if they are not of a snapshot.
[[nodiscard]] std::optional<SnapshotOrigin> origin_of_snapshot(std::string_view bytes);
inline constexpr std::size_t kSnapshotHeadMax = 256;

}  // namespace octoskin
