// The scenario and the world that a recording was made in, found again: judging in another one gives figures
// that look right and mean nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/lab/simulation/scene.hpp"

namespace octoskin::app {

/// What the command line says; empty: not given.
struct GivenScene {
    std::filesystem::path scenario;
    std::filesystem::path world;
};

struct RecordedScene {
    Scene scene;
    std::vector<std::string> warnings;  ///< where what was given is not what meta.yaml names
};

/// The recording's scenario and world: the shipped ones, if they have the CRC-32 that its meta.yaml says;
/// else those that simulate put into the recording, if they are as it put them; else what lies there under
/// the recorded name; and nowhere else that the recording names. What is given goes first,
/// with a warning if it is something else. Refuses what is not there, what has changed, and what meta.yaml
/// does not name; but a robot's recording names no world: then the scenario's is taken, with a warning.
[[nodiscard]] Result<RecordedScene, AppError> read_recorded_scene(const FilePlace& recording,
                                                                  const GivenScene& given);

}  // namespace octoskin::app
