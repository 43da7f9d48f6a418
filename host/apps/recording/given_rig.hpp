// A rig that somebody gave, for those who tell the person what is wrong with it.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// rig::read_rig(), its error with an exit code: one that may not be read (no_permission), or `otherwise`.
[[nodiscard]] Result<rig::Rig, AppError> read_given_rig(const FilePlace& file,
                                                        const std::filesystem::path& robot = {},
                                                        ExitCode otherwise = ExitCode::bad_config);

/// The text of its robot's URDF. Error (bad_config; no_permission): it cannot be read.
[[nodiscard]] Result<std::string, AppError> robot_text(const rig::Rig& rig);

}  // namespace octoskin
