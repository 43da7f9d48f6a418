// A planner's query about a motion of the robot: all postures from one joint configuration to the next.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "host/core/query/robot_query.hpp"

namespace octoskin {

struct LegConfig {
    double reach_m = 0.5;  ///< limit of clearances; 0: no clearances
    /// The field of the same map: distances come from it and are the same. Null: they are searched for in the
    /// map.
    const DistanceField* field = nullptr;
    FreeDemand demand = {};
    /// Called before each posture; true skips the remaining ones. Empty: no early end.
    std::function<bool()> is_ending = {};
};

/// The straight way in joint space from one configuration to another, in equal parts. The posture in the
/// middle of each part represents the whole part: its capsules are enlarged by their movement to the part's
/// ends. The last posture is the end itself. So no posture on the way occupies space that none of these
/// occupies. No part moves a point of a capsule's axis by more than half a voxel's edge, so no capsule is
/// enlarged by more than a quarter of an edge. A leg from a configuration to itself has only that posture.
class Leg {
  public:
    static constexpr double kStep = 0.05;

    /// `from`, `to`: one position per joint, finite, within the robot's limits or beyond. `step`: upper limit
    /// of each joint's movement in one part, rad or m, above 0 (asserted); smaller steps enlarge the capsules
    /// less. About 2 us for each 0.05 rad of all joints together, 1 ms at most.
    Leg(const RobotQuery& robot, const FusedMap& map, std::span<const double> from,
        std::span<const double> to, double step = kStep);

    /// At least 1 and about 1e15 at most. It grows with the length of the way; the caller must limit it.
    [[nodiscard]] std::size_t postures() const noexcept { return parts_ + 1; }
    /// Position of a posture on the way, up to 1.
    [[nodiscard]] double share(std::size_t index) const noexcept {
        return index < parts_ ? (static_cast<double>(index) + 0.5) / static_cast<double>(parts_) : 1.0;
    }
    void position(std::size_t index, std::span<double> position) const noexcept;
    /// The enlarged capsules of a posture. `robot`: the robot that the leg was built with. Errors: those of
    /// RobotQuery::pose, and ambiguous_turn.
    [[nodiscard]] Result<std::vector<PosedCapsule>, PostureFault> pose(const RobotQuery& robot,
                                                                       std::size_t index) const;

  private:
    std::vector<double> from_;
    std::vector<double> to_;
    std::optional<PostureFault> fault_;
    std::size_t parts_ = 0;
    std::vector<double> margins_m_;  ///< enlargement of each capsule in the middle of a part
};

struct LegAnswer {
    /// The worst of all postures; of equals the first. Free means free all the way. Other states may lie
    /// beside the way, by at most a quarter of a voxel's edge. Never free for a robot with unknown links.
    PostureAnswer worst;
    double share = 1.0;  ///< position of `worst` on the way
    /// The least clearance on the way, or less by up to a quarter of a voxel's edge; empty if the reach is 0.
    PostureClearance clearance;
    /// The weakest evidence of all postures; empty if the map has no ages.
    std::optional<PostureEvidence> evidence;
    /// The free voxel with the least evidence of all postures; empty if they touch none.
    std::optional<PostureFree> free;
    std::size_t postures = 0;  ///< postures tested: a blocked way is not followed further
};

/// Queries all postures after the leg's beginning. `robot`: the robot that the leg was built with; `map`: a
/// map of the same resolution. About 0.1 ms per posture at 0.04 m.
[[nodiscard]] Result<LegAnswer, PostureFault> ask(const RobotQuery& robot, const FusedMap& map,
                                                  const Leg& leg, const LegConfig& config);

}  // namespace octoskin
