// Provenance of a map: its maps.yaml and the recording from which it was made.
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
    std::optional<MapOrigin> origin;     ///< empty unless it describes this map
    std::optional<FilePlace> recording;  ///< its directory
    std::vector<std::string> warnings;   ///< about unknown or unreadable provenance
};

/// Whether the map was made from a data set, which has no robot.
[[nodiscard]] bool is_of_data_set(const MapOrigin& origin);

/// The contents of the maps.yaml beside the map; empty if it does not describe the map. Errors (bad_data): it
/// cannot be read, or describes other bytes than those of the map.
[[nodiscard]] Result<std::optional<MapOrigin>, AppError> origin_of_map(const std::filesystem::path& map);

/// The recording is `given`, if that is not empty, else the one beside the map. A recording named in
/// maps.yaml is opened only below the map's own folder: otherwise a map from another person would determine
/// which files are opened.
/// Errors (bad_data): a maps.yaml that cannot be read; one that describes other bytes than those of the map;
/// one that was written for another recording than the given one or the one beside the map.
[[nodiscard]] Result<MapProvenance, AppError> provenance_of_map(const std::filesystem::path& map,
                                                                const std::filesystem::path& given = {});

}  // namespace octoskin::app
