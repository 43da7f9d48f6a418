// Holds readings that another sender may still contradict.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/beams/range_measurement.hpp"

namespace octoskin {

/// Bounded: each sensor has 64 numbers, and at most one reading of each number is held.
class ReadingHold {
  public:
    /// False: a reading of the same sensor and number is already held; this one is not stored.
    [[nodiscard]] bool put(const RangeMeasurement& measurement, std::uint8_t sequence, HostTime until);
    /// Removes the reading of this number. Returns how many there were, 0 or 1.
    std::size_t drop(wire::NodeId node, std::uint8_t sensor, std::uint8_t sequence);
    /// Removes all readings of this sensor. Returns how many there were.
    std::size_t drop(wire::NodeId node, std::uint8_t sensor);
    /// Removes and returns readings that are due, or whose due time is far from `now` after a time jump,
    /// earliest first.
    [[nodiscard]] std::vector<RangeMeasurement> take_due(HostTime now);
    /// Removes and returns all readings, earliest first.
    [[nodiscard]] std::vector<RangeMeasurement> take_all();
    [[nodiscard]] std::size_t size() const noexcept { return waiting_.size(); }

  private:
    using Key = std::tuple<wire::NodeId, std::uint8_t, std::uint8_t>;  ///< node, sensor, number
    struct Waiting {
        RangeMeasurement measurement;
        HostTime until;
    };
    std::map<Key, Waiting> waiting_;
};

}  // namespace octoskin
