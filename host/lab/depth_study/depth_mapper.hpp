// A camera's frames into a map by the product's own stages, without a robot and without files.
#pragma once

#include <Eigen/Geometry>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/depth_stage.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin::depth_study {

class DepthMapper {
  public:
    /// `mapping` must not remove the robot (asserted).
    DepthMapper(const rig::Camera& camera, const Eigen::Isometry3d& T_map_base, const MappingConfig& mapping);

    /// As the pipeline does: evidence of earlier estimates is retracted before the frame's terms are applied.
    /// Frames in the order of their times. A frame without a pose is from the camera's place in the rig.
    /// Error (bad_data): the stage refuses the frame.
    [[nodiscard]] Status<AppError> take(const DepthFrame& frame);
    [[nodiscard]] const FusedMap& map() const noexcept { return map_; }

  private:
    DepthStage stage_;
    FusedMap map_;
};

}  // namespace octoskin::depth_study
