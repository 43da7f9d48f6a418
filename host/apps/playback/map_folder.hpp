// The maps of one playback in a folder, with their provenance. A save replaces all of them or, on an error,
// none.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/apps/playback/map_origin.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_set.hpp"

namespace octoskin {

using NamedMaps = std::vector<std::pair<std::string, const FusedMap*>>;

/// The requested ones of depth, proximity and fused. No depth map without depth frames, no proximity map for
/// a rig without sensor boards. The maps belong to the playback.
[[nodiscard]] NamedMaps named_maps(const Playback& playback);

/// What to report about the folder after a save.
struct SavedMaps {
    std::vector<std::string> removed;  ///< maps of the previous playback that this one does not have
    std::vector<std::string>
        foreign;  ///< maps that octoskin, as far as is known, did not write: left unchanged
};

/// Checks that save() can replace whatever exists under the names of the maps and of maps.yaml.
[[nodiscard]] Status<AppError> check_map_places(const OpenFolder& folder);

/// A folder that is locked from the moment it is opened, so that a second octoskin is refused before it
/// starts work.
class MapFolder {
  public:
    /// Creates the folder if it does not exist, and locks it: see FileSet::begin(). Errors: those of
    /// check_map_places().
    [[nodiscard]] static Result<MapFolder, AppError> open(const FilePlace& folder);

    /// Writes each map as .ot, .bt and .ply, and maps.yaml. May be called once. On an error the previous maps
    /// are unchanged. `origin`: provenance of the maps; save() fills in the maps' checksums.
    [[nodiscard]] Result<SavedMaps, AppError> save(const NamedMaps& maps, MapOrigin origin);

    [[nodiscard]] const OpenFolder& folder() const noexcept { return files_.folder(); }

  private:
    explicit MapFolder(FileSet files) : files_(std::move(files)) {}
    FileSet files_;
};

}  // namespace octoskin
