#include "host/apps/explain/explanation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "host/core/rig/camera_text.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {
namespace {

std::vector<std::string> camera_names(const rig::Rig& rig) {
    std::vector<std::string> names;
    for (const rig::Camera& camera : rig.cameras)
        if (!camera.name.empty()) names.push_back(camera.name);
    return names;
}

std::map<BeamSource, std::string> names_of_sources(const rig::Rig& rig) {
    std::map<BeamSource, std::string> names{{source_of_camera(0), camera_text("")}};
    for (std::size_t i = 0; i < rig.cameras.size(); ++i)
        names[source_of_camera(i)] = camera_text(rig.cameras[i].name);
    for (const rig::Node& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            const std::size_t zones = node.sensors[i].zone_offset_m.size();
            for (std::size_t zone = 0; zone < zones; ++zone) {
                const BeamSource source{node.config.node_id, static_cast<std::uint8_t>(i),
                                        static_cast<std::uint8_t>(zone)};
                names[source] =
                    node.sensors[i].name + (zones > 1 ? fmt::format(" zone {}", zone) : std::string());
            }
        }
    }
    return names;
}

/// The full map had no room for the voxel. A map that is full stays full, so it refused all terms for the
/// voxel.
bool is_without_room(const FusedMap& map, const VoxelTrace& trace) {
    return map.counters().no_room > 0 && trace.count() > 0 && trace.forgotten().times == 0 &&
           !map.log_odds(trace.key());
}

}  // namespace

Result<Explanation, AppError> explain(PlaybackRequest request, const Eigen::Vector3d& p_map,
                                      std::size_t contributions_max, const ReplayReport& report) {
    const FusedMap grid(request.mapping.map);
    const auto key = grid.key_of(p_map);
    if (!key) {
        return fail(ExitCode::usage,
                    {.code = ErrorCode::out_of_range,
                     .what = fmt::format("expected a point within the map, {:.0f} m about its origin",
                                         32768 * grid.resolution_m()),
                     .value = fmt::format("{} {} {}", p_map.x(), p_map.y(), p_map.z()),
                     .key = "x y z"});
    }
    VoxelTrace trace(*key, request.mapping.map, contributions_max);
    request.maps = {MapFeed::both};
    request.listener = &trace;
    const auto played = play_recording(request, report);
    if (!played) return unexpected(played.error());
    if (auto failure = failure_of(*played)) return unexpected(std::move(*failure));
    const FusedMap& map = played->pipeline.map();
    std::uint64_t no_room = 0;
    if (is_without_room(map, trace)) {
        no_room = trace.count();
        trace = VoxelTrace(*key, request.mapping.map, contributions_max);
    }
    // Tolerance: the sum of many single-precision changes has rounding errors.
    constexpr double kOff = 1e-3;
    const double off = trace.sum() - static_cast<double>(trace.log_odds().value_or(0.0F));
    if (map.log_odds(*key) != trace.log_odds() || std::fabs(off) > kOff)
        return fail(ExitCode::failed, {ErrorCode::self_check,
                                       "the terms do not add up to the log-odds of the voxel in the map"});
    return Explanation{.p_map = p_map,
                       .centre = map.centre_of(*key),
                       .resolution_m = map.resolution_m(),
                       .occupancy = map.occupancy(*key),
                       .no_room = no_room,
                       .trace = std::move(trace),
                       .begin = played->outcome.progress.begin,
                       .names = names_of_sources(played->rig),
                       .cameras = camera_names(played->rig),
                       .warnings = played->warnings,
                       .lost = loss_of(*played)};
}

}  // namespace octoskin
