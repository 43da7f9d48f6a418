// `octoskin explain`: which readings and depth frames determined the state of a voxel.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/explain/voxel_trace.hpp"
#include "host/apps/playback/playback.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

struct Explanation {
    Eigen::Vector3d p_map = Eigen::Vector3d::Zero();   ///< the requested point, map frame, metres
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< centre of its voxel, map frame, metres
    double resolution_m = 0.0;
    Occupancy occupancy = Occupancy::unknown;
    /// Contributions that the full map refused; the voxel trace contains none of them.
    std::uint64_t no_room = 0;
    VoxelTrace trace;
    std::optional<HostTime> begin;  ///< of the recording: the zero of all times in the text
    /// "camera", "camera 'left'", "forearm_3"; with the zone if the sensor has several.
    std::map<BeamSource, std::string> names;
    std::vector<std::string> cameras = {};  ///< names of the rig's cameras; empty: it has one without a name
    std::vector<std::string> warnings;      ///< of the replay
    std::optional<AppError> lost =
        std::nullopt;  ///< set if most of the recording was lost although there is an explanation
};

/// Replays the recording as `octoskin replay` does and traces the voxel at `p_map` (metres, map frame) in the
/// fused map. Errors: those of the replay; a point outside the octree (usage); terms that do not add up to
/// the map's log-odds (failed).
[[nodiscard]] Result<Explanation, AppError> explain(PlaybackRequest request, const Eigen::Vector3d& p_map,
                                                    std::size_t contributions_max,
                                                    const ReplayReport& report = {});

/// One sentence: "occupied, mainly by sensor forearm_3 between 4.100 and 4.600 s, 12 hits; the camera saw it
/// free in 3 frames, and never occupied".
[[nodiscard]] std::string conclusion_of(const Explanation& explanation);
/// Text for people: the voxel, the share of each source, the newest contributions, the conclusion.
[[nodiscard]] std::string to_text(const Explanation& explanation);
[[nodiscard]] nlohmann::ordered_json to_json(const Explanation& explanation);

}  // namespace octoskin
