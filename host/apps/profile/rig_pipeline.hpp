// Makes the pipeline that builds maps from the readings of a rig, with a given mapping profile.
#pragma once

#include <string>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// `rig_file`: the name for messages. Errors (bad_config): the rig names a link that the robot does not have;
/// a reading of a sensor can cover more voxels than one reading may have (`find_oversized_cone`).
[[nodiscard]] Result<Pipeline, AppError> build_pipeline(const std::string& rig_file, const HostRig& rig,
                                                        RobotModel robot, const MappingConfig& mapping,
                                                        const PipelineConfig& config);

}  // namespace octoskin
