// A planner's question about a way of the robot: every posture from one joint configuration to the next.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "host/core/query/robot_query.hpp"

namespace octoskin {

struct LegConfig {
    double reach_m = 0.5;  ///< up to here clearances are told; 0: none are
    /// Of the same map: then distances come from there, and are the same. Null: they are searched for.
    const DistanceField* field = nullptr;
    /// Asked before each posture: once it says true, the others are left out. Empty: nobody ends it.
    std::function<bool()> is_ending = {};
};

/// The straight way in joint space from one configuration to another, in equal parts: a posture in the middle
/// of each part stands for all of it, with capsules larger by as much as they move from there to the part's
/// ends, and the last posture is the end itself. So no posture on the way takes space that none of these
/// takes. No part moves a point of a capsule's axis by more than half a voxel's edge, so that no capsule is
/// larger by more than a quarter of one. From a configuration to itself there is that one posture.
class Leg {
  public:
    static constexpr double kStep = 0.05;

    /// `from`, `to`: a position of each joint, finite, within the robot's limits or beyond. `step`: in no
    /// part any joint moves by more, rad or m, above 0 (asserted); the smaller, the less larger the capsules
    /// are. About 2 us for each 0.05 rad that all joints together turn, 1 ms at most.
    Leg(const RobotQuery& robot, const FusedMap& map, std::span<const double> from,
        std::span<const double> to, double step = kStep);

    /// At least 1, and some 1e15 at most. The caller bounds it: it is as large as the way is long.
    [[nodiscard]] std::size_t postures() const noexcept { return parts_ + 1; }
    /// Of the way, up to 1.
    [[nodiscard]] double share(std::size_t index) const noexcept {
        return index < parts_ ? (static_cast<double>(index) + 0.5) / static_cast<double>(parts_) : 1.0;
    }
    void position(std::size_t index, std::span<double> position) const noexcept;
    /// The capsules of a posture, larger as said. `robot`: that which the leg was made of.
    [[nodiscard]] Result<std::vector<PosedCapsule>, PostureFault> pose(const RobotQuery& robot,
                                                                       std::size_t index) const;

  private:
    std::vector<double> from_;
    std::vector<double> to_;
    std::size_t parts_ = 0;
    std::vector<double> margins_m_;  ///< of each capsule, in the middle of a part
};

struct LegAnswer {
    /// Of all its postures; of equals the first. Free is free all the way; what is not may lie beside the
    /// way, by a quarter of a voxel's edge at most. Never free for a robot with unknown links.
    PostureAnswer worst;
    double share = 1.0;  ///< of the way, where that is
    /// The least on the way, or up to a quarter of a voxel's edge less; of nothing if the reach is 0.
    PostureClearance clearance;
    /// What the answer rests on, of all its postures; empty if the map tells no ages.
    std::optional<PostureEvidence> evidence;
    std::size_t postures = 0;  ///< that were asked about: a way that is blocked is not followed further
};

/// Of all postures after the leg's beginning. `robot`: that which the leg was made of; `map`: one of the same
/// resolution. Some 0.1 ms a posture at 0.04 m.
[[nodiscard]] Result<LegAnswer, PostureFault> ask(const RobotQuery& robot, const FusedMap& map,
                                                  const Leg& leg, const LegConfig& config);

}  // namespace octoskin
