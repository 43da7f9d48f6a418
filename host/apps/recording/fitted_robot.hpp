// The body of a rig's robot whose URDF has meshes: fitted once, and kept by content.
#pragma once

#include <cstdint>
#include <filesystem>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

enum class RobotFitting : std::uint8_t {
    if_needed,  ///< takes seconds the first time
    kept_only,  ///< an error with the command that fits, unless the fit is kept: for a daemon
};

/// $XDG_CACHE_HOME/octoskin/robots, or ~/.cache/octoskin/robots; empty without either.
[[nodiscard]] std::filesystem::path fitted_robot_folder();

/// Sets `rig.urdf` to the fitted URDF (host/io/robot) if a <collision> at or below the base link is a mesh,
/// and the URDF is not part of a recording, which has a fitted one. Returns whether it did. Errors: those of
/// fit_robot() and fit_key(); no place to keep it; for kept_only, that it is not kept.
[[nodiscard]] Result<bool, AppError> use_fitted_robot(rig::Rig& rig, RobotFitting fitting);

}  // namespace octoskin
