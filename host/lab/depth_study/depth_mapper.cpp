#include "host/lab/depth_study/depth_mapper.hpp"

#include <cassert>

#include "host/core/ingest/reasons.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin::depth_study {
namespace {

HostRig without_robot(const rig::Camera& camera, const Eigen::Isometry3d& T_map_base) {
    HostRig rig;
    rig.T_map_base = T_map_base;
    rig.cameras = {host_camera(camera)};
    rig.cameras.front().noise.reset();  // that of the mapping is under study
    return rig;
}

}  // namespace

DepthMapper::DepthMapper(const rig::Camera& camera, const Eigen::Isometry3d& T_map_base,
                         const MappingConfig& mapping)
    : stage_(without_robot(camera, T_map_base), mapping), map_(mapping.map) {
    assert(!stage_.needs_robot());
}

Status<AppError> DepthMapper::take(const DepthFrame& frame) {
    const auto updates = stage_.updates(frame, nullptr);
    if (!updates) {
        const auto reason = static_cast<std::size_t>(updates.error());
        return fail(ExitCode::bad_data, {.code = ErrorCode::unsupported,
                                         .what = "the camera's image cannot be mapped",
                                         .value = names_of(DepthReason{}).at(reason)});
    }
    stage_.keep(frame);
    map_.advance_time(frame.captured);
    if (!updates->retracted.empty()) map_.apply(updates->retracted);
    map_.apply(updates->terms);
    return Done{};
}

}  // namespace octoskin::depth_study
