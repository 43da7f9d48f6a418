// Evaluates a query against a map.
#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "host/apps/query/kept_field.hpp"
#include "host/apps/query/query_request.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/free_evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The state against which a request is evaluated.
struct QueryGround {
    const HostRig* rig = nullptr;
    const RobotModel* robot = nullptr;
    /// A copy, in which the arm's own space is freed.
    FusedMap map;
    /// The arm's present joint positions; empty: unknown. They are the query if the request has no path.
    std::vector<double> present;
    /// A distance field that is kept between queries. Null: each distance is searched for in the map.
    KeptField* field = nullptr;
    /// True: the map is that of a running arm. If `present` is empty, its own space is unknown, and a request
    /// to free it is refused. False: the path's beginning serves as the arm's posture if `present` is empty.
    /// For a single posture, the answer then includes the space that this posture frees.
    bool is_live = false;
    /// Of the mapping that makes the map. A file does not contain it, nor counts of ranges.
    MissUnits units = {};
    /// Wall time of the map's state; empty for a file, which does not contain it.
    std::optional<WallTime> map_time = std::nullopt;
    /// The largest processor time of one query, because others wait. Empty: no limit.
    std::optional<std::chrono::milliseconds> work_max = std::nullopt;
};

/// "ok": true, or false with "exit", the exit code, and "error", an object as by to_json(), and with
/// "configuration" where the error is one of the path's. "own_space_m": as in the request, or null. Of
/// postures: "state", the worst, and "legs", one for each configuration: the way to it from the one before.
/// Of pockets: "pockets". All keys: docs/reference/control-socket.md. About 0.1 ms a posture. `is_ending` is
/// called before each posture and every few thousand voxels; if it returns true, the query ends with an
/// error. It also ends with an error after `work_max`; that error states which value to reduce.
[[nodiscard]] nlohmann::ordered_json answer_query(
    const QueryRequest& request, QueryGround ground,
    const std::function<bool()>& is_ending = [] { return false; });

/// An answer that is an error.
[[nodiscard]] nlohmann::ordered_json query_refused(const AppError& error);

/// The error of such an answer; empty if the answer is not an error.
[[nodiscard]] std::optional<AppError> refusal_of(const nlohmann::ordered_json& answer);

/// Text for people, several lines. Throws nlohmann::ordered_json::exception if `answer` is not an answer of a
/// daemon of this version.
[[nodiscard]] std::string query_text(const nlohmann::ordered_json& answer);

}  // namespace octoskin
