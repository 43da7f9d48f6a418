#include "host/apps/profile/rig_pipeline.hpp"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "host/core/mapping/cone_size.hpp"
#include "host/core/pipeline/oversized_cone.hpp"
#include "host/core/rig/sensor_text.hpp"

namespace octoskin {
namespace {

AppError too_large(const std::string& rig_file, const HostRig& rig, const MappingConfig& mapping,
                   const OversizedCone& cone) {
    constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;
    const std::string length_key =
        cone.has_range ? "range_limits.max_m of the rig" : "no_return_clear_m of the mapping";
    return {
        ExitCode::bad_config,
        {.code = ErrorCode::limit_exceeded,
         .what =
             fmt::format("expected a reading with a half angle of {:.3g} degrees and {:.3g} m ({}) to cover "
                         "at most {:.0f} voxels of {} m (map.resolution_m of the mapping)",
                         kDegreesPerRad * cone.optics.half_angle_rad, cone.length_m, length_key,
                         kConeVoxelsMax, mapping.map.resolution_m),
         .value = fmt::format("{:.2g}", cone.voxels),
         .remedy = fmt::format("raise map.resolution_m to {:.2g} or more, or lower {}, or half_angle_deg or "
                               "sigma_deg of the sensor's cone",
                               cone.resolution_min_m, length_key),
         .file = rig_file,
         .key = sensor_text(rig.nodes[cone.node], cone.sensor)}};
}

}  // namespace

Result<Pipeline, AppError> build_pipeline(const std::string& rig_file, const HostRig& rig, RobotModel robot,
                                          const MappingConfig& mapping, const PipelineConfig& config) {
    if (const auto cone = find_oversized_cone(rig, mapping))
        return unexpected(too_large(rig_file, rig, mapping, *cone));
    auto pipeline = Pipeline::build(rig, std::move(robot), mapping, config);
    if (pipeline) return std::move(pipeline).value();
    return fail(ExitCode::bad_config, {.code = ErrorCode::unknown_name,
                                       .what = "the rig names a link or joint that the robot does not have",
                                       .value = "'" + pipeline.error().element + "'",
                                       .file = rig_file});
}

}  // namespace octoskin
