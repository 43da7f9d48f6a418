// What a map answers.
#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/querying/kept_field.hpp"
#include "host/apps/querying/query_request.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// What there is to be asked.
struct QueryGround {
    const HostRig* rig = nullptr;
    const RobotModel* robot = nullptr;
    /// A copy of its own: what is the arm's own space is freed in it.
    FusedMap map;
    /// The joints as the arm stands; empty: nobody knows. It is what is asked about where the request names
    /// no path.
    std::vector<double> present;
    /// For distances; what was asked of it before is kept. Null: they are searched for.
    KeptField* field = nullptr;
    /// The arm stands somewhere now: without `present` nothing is its own space. Else it stands where the
    /// path begins; of a single posture the answer is then about what that frees itself.
    bool is_live = false;
    /// When the map was as it is, by this machine's clock; empty: of a file, which does not say.
    std::optional<WallTime> map_time = std::nullopt;
    /// The most processor time for one question: others wait. Empty: as much as it takes.
    std::optional<std::chrono::milliseconds> work_max = std::nullopt;
};

/// "ok": true, or false with "error" and "code", the exit code for it, and with "configuration" where the
/// error is one of the path's. "own_space_m": as in the request, or null. Of postures: "state", the worst,
/// and "legs", one for each configuration: the way to it from the one before. Of pockets: "pockets". All
/// keys: docs/planner.md. Some 0.1 ms a posture; `is_ending` is asked before each posture and each few
/// thousand voxels, and true ends it with an error; so does the end of `work_max`, which says what to make
/// smaller.
[[nodiscard]] nlohmann::ordered_json answer_query(
    const QueryRequest& request, QueryGround ground,
    const std::function<bool()>& is_ending = [] { return false; });

/// An answer that is an error.
[[nodiscard]] nlohmann::ordered_json query_refused(const AppError& error);

/// Such an answer back; empty: it is none.
[[nodiscard]] std::optional<AppError> refusal_of(const nlohmann::ordered_json& answer);

/// For a person, several lines. Throws nlohmann::ordered_json::exception if it is not what a daemon of this
/// version answers.
[[nodiscard]] std::string query_text(const nlohmann::ordered_json& answer);

}  // namespace octoskin
