// The maps of one playback in a folder: all of them, or those that were there before.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

using NamedMaps = std::vector<std::pair<std::string, const FusedMap*>>;

/// depth, proximity and fused, as far as they were asked for; no depth without depth frames. They belong to
/// the playback.
[[nodiscard]] NamedMaps named_maps(const Playback& playback);

/// Writes each as .ot, .bt and .ply into `folder`, which is made if it is not there. They are written beside
/// and renamed when all are whole, so an error while writing leaves the former ones untouched.
[[nodiscard]] Status<AppError> save_maps(const NamedMaps& maps, const std::filesystem::path& folder);

}  // namespace octoskin
