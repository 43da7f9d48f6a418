// Where a map comes from: its maps.yaml, and the recording that it was made from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/playback/map_origin.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin::app {

struct MapProvenance {
    std::optional<MapOrigin> origin;     ///< that speaks of this map
    std::optional<FilePlace> recording;  ///< its directory
    std::vector<std::string> warnings;   ///< of what is not known, or cannot be read
};

/// Whether the map was made from a data set, which has no robot.
[[nodiscard]] bool is_of_data_set(const MapOrigin& origin);

/// What the maps.yaml beside the map says of it; empty: nothing. Errors (bad_data): it cannot be read, or
/// describes other bytes than the map has.
[[nodiscard]] Result<std::optional<MapOrigin>, AppError> origin_of_map(const std::filesystem::path& map);

/// The recording is the `given` one, if it is not empty, else the one beside the map. What maps.yaml names is
/// opened only below the map's own folder: a map of somebody else would choose what is opened. Refuses
/// (bad_data) a maps.yaml that cannot be read, one that describes other bytes than the map has, and one that
/// was written of another recording than is given or lies beside the map.
[[nodiscard]] Result<MapProvenance, AppError> provenance_of_map(const std::filesystem::path& map,
                                                                const std::filesystem::path& given = {});

}  // namespace octoskin::app
