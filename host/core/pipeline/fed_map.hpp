// The maps that are built at the same time, and the sensors that feed each of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/voxels/sensor_kind.hpp"

namespace octoskin {

enum class MapFeed : std::uint8_t { camera, ranges, both };

/// Name of the map in files and tables.
[[nodiscard]] constexpr std::string_view name_of(MapFeed feed) noexcept {
    switch (feed) {
        case MapFeed::camera:
            return "depth";
        case MapFeed::ranges:
            return "proximity";
        case MapFeed::both:
            break;
    }
    return "fused";
}

struct FedMap {
    MapFeed feed = MapFeed::both;
    FusedMap map;

    [[nodiscard]] bool takes(SensorKind sensor) const noexcept {
        return feed == MapFeed::both || (feed == MapFeed::camera) == (sensor == SensorKind::camera);
    }
};

/// The maps that an experiment compares; a daemon builds only `both`.
[[nodiscard]] inline std::vector<MapFeed> every_feed() {
    return {MapFeed::camera, MapFeed::ranges, MapFeed::both};
}

/// Null if there is none.
[[nodiscard]] inline const FusedMap* find_map(std::span<const FedMap> maps, MapFeed feed) noexcept {
    const auto found = std::ranges::find(maps, feed, &FedMap::feed);
    return found == maps.end() ? nullptr : &found->map;
}

}  // namespace octoskin
