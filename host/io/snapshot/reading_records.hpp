// What range sensors read, zone by zone, as records.
#pragma once

#include <string_view>

#include "host/core/mapping/stationary_model.hpp"
#include "host/core/mapping/stationary_sensors.hpp"
#include "host/io/snapshot/blocks.hpp"

namespace octoskin::snapshot {

/// Throws std::bad_alloc.
void put_readings(BlockWriter& blocks, const StationaryReadings& readings);

/// Take what a block of BlockKind::confirmed or BlockKind::seen holds, behind what is there. False: it cannot
/// be. Throw std::bad_alloc.
[[nodiscard]] bool take_confirmed(std::string_view payload, const StationaryModel& model,
                                  ConfirmedRanges::Sensors& sensors);
[[nodiscard]] bool take_seen(std::string_view payload, SeenThrough::Zones& zones);

/// How many zones they have.
[[nodiscard]] std::uint64_t zones_of(const ConfirmedRanges::Sensors& sensors) noexcept;

}  // namespace octoskin::snapshot
