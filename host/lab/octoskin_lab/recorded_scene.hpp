// Finds the scenario and the world of a recording. An evaluation against another world gives plausible but
// meaningless figures.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/lab/simulation/scene.hpp"

namespace octoskin::app {

/// Paths on the command line; empty: not given.
struct GivenScene {
    std::filesystem::path scenario;
    std::filesystem::path world;
};

struct RecordedScene {
    Scene scene;
    std::vector<std::string> warnings;  ///< for each given file that is not the one in meta.yaml
};

/// The recording's scenario and world. Search order: the files in `given`, with a warning if they differ from
/// the recorded ones; the shipped files, if their CRC-32 is that of meta.yaml; the files that simulate wrote
/// into the recording, if unchanged; a file of the recorded name in the recording. No other path of the
/// recording is opened. Errors: a file is missing, changed, or not named in meta.yaml. A recording of a real
/// robot names no world: the scenario's world is used, with a warning.
[[nodiscard]] Result<RecordedScene, AppError> read_recorded_scene(const FilePlace& recording,
                                                                  const GivenScene& given);

}  // namespace octoskin::app
