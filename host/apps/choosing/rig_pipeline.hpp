// What builds maps of the readings of a rig, by the mapping that a person names.
#pragma once

#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// `rig_file`: as a person knows it. Errors (bad_config): a link of the rig that the robot does not have; a
/// sensor that sees more of the mapping's voxels than one reading may have (`find_oversized_cone`).
[[nodiscard]] Result<Pipeline, AppError> build_pipeline(const std::string& rig_file, const HostRig& rig,
                                                        RobotModel robot, const MappingConfig& mapping,
                                                        const PipelineConfig& config);

}  // namespace octoskin
