// Reads a rig that the user named, with errors for the user.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// rig::read_rig() with an exit code for its error: no_permission if the file may not be read, else
/// `otherwise`.
[[nodiscard]] Result<rig::Rig, AppError> read_given_rig(const FilePlace& file,
                                                        const std::filesystem::path& robot = {},
                                                        ExitCode otherwise = ExitCode::bad_config);

/// The text of the rig's URDF. Error (bad_config; no_permission): it cannot be read.
[[nodiscard]] Result<std::string, AppError> robot_text(const rig::Rig& rig);

}  // namespace octoskin
