// The scene of a simulation as files of its recording. An evaluation needs no other files.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/recording.hpp"
#include "host/lab/simulation/scene.hpp"

namespace octoskin {

/// Why a recording does not contain its scene; empty: it does.
using SceneGap = std::optional<std::string>;

/// Writes scenario.yaml, world.sdf, the meshes and motion.yaml into the recording, whose folder is open to
/// write to, and reads them back. They must be the same scene, triangle by triangle; else all are removed and
/// the gap is returned. Error (cannot_create): they cannot be written. Call under lock_reading() if other
/// threads may read. `on_warning`: called once if meshes are left out that no sensor sees.
[[nodiscard]] Result<SceneGap, AppError> write_scene(
    const Scene& scene, const RecordingPaths& recording,
    const std::function<void(const std::string&)>& on_warning = {});

/// CRC-32 of the scene's files in the recording, one after the other, each with its name; empty if scenario
/// or world is missing, or one cannot be read or
/// is larger than write_scene() makes it.
[[nodiscard]] std::optional<std::uint32_t> crc32_of_scene(const RecordingPaths& recording);

}  // namespace octoskin
