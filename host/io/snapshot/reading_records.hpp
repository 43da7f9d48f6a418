// The readings of range sensors, zone by zone, as records.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/sensor_history.hpp"
#include "host/core/mapping/stationary_model.hpp"
#include "host/io/snapshot/blocks.hpp"

namespace octoskin::snapshot {

/// Throws std::bad_alloc.
void put_readings(BlockWriter& blocks, const SensorHistories& histories);

/// Reads the content of blocks of BlockKind::confirmed and BlockKind::seen, each kind in its order. False:
/// the content is invalid. Throws std::bad_alloc.
class ReadingsTaker {
  public:
    explicit ReadingsTaker(SensorHistories& histories) : histories_(histories) {}

    [[nodiscard]] bool take_confirmed(std::string_view payload, const StationaryModel& model);
    [[nodiscard]] bool take_seen(std::string_view payload);

  private:
    SensorHistories& histories_;
    std::optional<BeamSource> newest_confirmed_;
    std::optional<BeamSource> newest_seen_;
};

/// Number of zones with a record of each kind.
struct ZoneCounts {
    std::uint64_t confirmed = 0;
    std::uint64_t seen = 0;
};
[[nodiscard]] ZoneCounts count_zones(const SensorHistories& histories) noexcept;

}  // namespace octoskin::snapshot
