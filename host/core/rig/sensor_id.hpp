// The key and the container for data that exist for each sensor.
#pragma once

#include <compare>
#include <cstdint>
#include <map>

namespace octoskin {

/// A sensor by its node and its local index on that node.
struct SensorId {
    std::uint8_t node_id = 0;
    std::uint8_t sensor = 0;
    friend constexpr auto operator<=>(const SensorId&, const SensorId&) = default;
};

/// Ordered by node id, then by sensor index.
template <class T>
using SensorTable = std::map<SensorId, T>;

}  // namespace octoskin
