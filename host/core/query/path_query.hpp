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
    /// Between two postures that are asked about no joint moves by more than this, rad or m; above 0
    /// (asserted).
    double step = 0.05;
    double reach_m = 0.5;  ///< up to here clearances are told; 0: none are
    /// Of the same map: then distances come from there, and are the same. Null: they are searched for.
    const DistanceField* field = nullptr;
    /// Asked before each posture: once it says true, the others are left out. Empty: nobody ends it.
    std::function<bool()> is_ending = {};
};

/// The postures on the straight way in joint space from one configuration to another: the first is one step
/// from the beginning, the last the end itself. Both as long (asserted) and finite.
class Leg {
  public:
    Leg(std::span<const double> from, std::span<const double> to, double step);

    /// At least 1, and 1e15 at most. The caller bounds it: it is as large as the way is long.
    [[nodiscard]] std::size_t postures() const noexcept { return postures_; }
    /// Of the way, up to 1.
    [[nodiscard]] double share(std::size_t index) const noexcept {
        return static_cast<double>(index + 1) / static_cast<double>(postures_);
    }
    void position(std::size_t index, std::span<double> position) const noexcept;

  private:
    std::vector<double> from_;
    std::vector<double> to_;
    std::size_t postures_;
};

struct LegAnswer {
    PostureAnswer worst;         ///< of all its postures; of equals the first
    double share = 1.0;          ///< of the way, where that is
    PostureClearance clearance;  ///< the least on the way; of nothing if the reach is 0
    /// What the answer rests on, of all its postures; empty if the map tells no ages.
    std::optional<PostureEvidence> evidence;
    std::size_t postures = 0;  ///< that were asked about: a way that is blocked is not followed further
};

/// A leg from a configuration to itself is that one posture. Some 0.1 ms a posture at 0.04 m.
[[nodiscard]] Result<LegAnswer, PostureFault> ask(const RobotQuery& robot, const FusedMap& map,
                                                  const Leg& leg, const LegConfig& config);

}  // namespace octoskin
