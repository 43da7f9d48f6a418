// Readings that wait whether another sender contradicts them.
#pragma once

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/beams/range_measurement.hpp"

namespace octoskin {

/// Bounded: each sensor has 64 numbers, and of each number one waits at most.
class ReadingHold {
  public:
    /// False: one of its sensor and number waits already, and this one does not.
    [[nodiscard]] bool put(const RangeMeasurement& measurement, std::uint8_t sequence, HostTime until);
    /// Takes out the one of this number: how many there were, 0 or 1.
    std::size_t drop(wire::NodeId node, std::uint8_t sensor, std::uint8_t sequence);
    /// Takes out all of this sensor: how many there were.
    std::size_t drop(wire::NodeId node, std::uint8_t sensor);
    /// Takes out those that have waited long enough, or from which "now" has leapt away, the earliest first.
    [[nodiscard]] std::vector<RangeMeasurement> take_due(HostTime now);
    /// Takes out all.
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
