// The maps of one playback in a folder, with what they were made from: all of them, or those that were there
// before.
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

/// depth, proximity and fused, as far as they were asked for; no depth without depth frames, no
/// proximity of a rig without sensor boards. They belong to
/// the playback.
[[nodiscard]] NamedMaps named_maps(const Playback& playback);

/// What a person should know of a folder after a save.
struct SavedMaps {
    std::vector<std::string> removed;  ///< maps of the playback before, which this one has none of
    std::vector<std::string>
        foreign;  ///< maps beside that no octoskin put there, as far as is known: left alone
};

/// That nothing lies in the place of a map, or of maps.yaml, that save() could not replace.
[[nodiscard]] Status<AppError> check_map_places(const OpenFolder& folder);

/// A folder that is ours from the moment it is opened, so that a second octoskin is refused before its work.
class MapFolder {
  public:
    /// Makes the folder if it is not there, and locks it: see FileSet::begin(). Refuses what
    /// check_map_places() does.
    [[nodiscard]] static Result<MapFolder, AppError> open(const FilePlace& folder);

    /// Writes each map as .ot, .bt and .ply, and maps.yaml; once. On an error those before are as they were.
    /// `origin`: what the maps were made from; their checksums are filled in.
    [[nodiscard]] Result<SavedMaps, AppError> save(const NamedMaps& maps, MapOrigin origin);

    [[nodiscard]] const OpenFolder& folder() const noexcept { return files_.folder(); }

  private:
    explicit MapFolder(FileSet files) : files_(std::move(files)) {}
    FileSet files_;
};

}  // namespace octoskin
