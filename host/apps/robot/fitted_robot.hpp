// Reads a rig whose robot may have meshes: capsules are fitted to them, and kept for the next time.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/robot/given_robot.hpp"
#include "host/io/robot/fit_ingredients.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

enum class BodyFitting : std::uint8_t {
    if_needed,  ///< takes about a second for each link, unless a fit of the same files is kept (FitStore)
    kept_only,  ///< for a daemon: without a kept fit, an error with the command that makes one
};

/// The robot of `rig` if its body needs a fit; nullopt if it has no mesh, or is inside a recording, which
/// contains the fitted robot. Errors (bad_config): those of read_robot_text().
[[nodiscard]] Result<std::optional<RobotText>, AppError> robot_to_fit(const rig::Rig& rig);

/// `rig` with a URDF that has no mesh. Errors: those of robot_to_fit(), find_ingredients() and fit_robot();
/// for kept_only no_data. A fit that cannot be kept is a warning in the log.
[[nodiscard]] Result<rig::Rig, AppError> with_fitted_body(rig::Rig rig,
                                                          const std::vector<PackagePath>& packages,
                                                          BodyFitting fitting);

/// read_given_rig() for commands that use the robot's body.
[[nodiscard]] Result<rig::Rig, AppError> read_rig_with_body(const FilePlace& file, const GivenRobot& robot,
                                                            BodyFitting fitting,
                                                            ExitCode otherwise = ExitCode::bad_config);

}  // namespace octoskin
