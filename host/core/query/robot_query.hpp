// A planner's query about the whole robot: whether a posture is free, and the nearest obstacle.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/kinematics/self_hit.hpp"
#include "host/core/query/capsule_query.hpp"
#include "host/core/query/distance_field.hpp"
#include "host/core/query/evidence.hpp"
#include "host/core/query/weakest_free.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// Ordered from best to worst.
enum class PostureState : std::uint8_t {
    free,
    stale,  ///< free, but not confirmed by a sensor for `age.stale_after_s`
    unknown,
    occupied,
};
[[nodiscard]] std::string_view name(PostureState state) noexcept;

/// The result for one posture.
struct PostureAnswer {
    PostureState state = PostureState::free;
    /// The link in that state that reaches furthest into it; empty for free.
    std::optional<LinkId> link;
    /// The voxel nearest to the axis of that link's body; for stale, and for free space with too little
    /// evidence, the voxel with the weakest.
    /// Empty for free, outside the octree, and if that link has no body.
    std::optional<VoxelKey> voxel;
};

/// Distance from the robot's surface, padding included, to the nearest voxel; 0 if it touches one. It covers
/// the bodies of the query. Links without a body may be nearer; the value is then an upper bound.
struct PostureClearance {
    std::optional<double> occupied_m;  ///< empty: beyond the reach
    std::optional<double> not_free_m;
    std::optional<LinkId> occupied_link;  ///< the link with this distance
    std::optional<LinkId> not_free_link;
};

struct RobotQueryConfig {
    double padding_m = 0.0;  ///< added to the radius of each capsule; 0 to 1 (else `bad_padding`)
    /// Links that the query leaves out, by name.
    std::vector<std::string> links_ignored = {};
    /// True: leaves out capsules that no joint moves, such as the base's. They touch the surface they stand
    /// on in all postures.
    bool ignores_unmoved = true;
    /// True: uses HostRig::certain_body in place of the body. It finds the space that is certainly the robot;
    /// it is not for queries.
    bool is_of_certain_body = false;
};

enum class RobotQueryError : std::uint8_t {
    unknown_link,  ///< `links_ignored` or the rig names a link that the robot does not have
    bad_padding,
    no_body,  ///< no body is left and no link is unknown: all answers would be "free"
};
struct RobotQueryFault {
    RobotQueryError error = RobotQueryError::unknown_link;
    std::string element;  ///< the link
};

enum class PostureError : std::uint8_t {
    wrong_count,  ///< number of joint positions
    not_finite,
    outside_limits,  ///< beyond a joint's limits by more than 0.005 (rad or m), the tolerance of joint
                     ///< samples
    ambiguous_turn,  ///< a leg turns a continuous joint by over half a turn
    too_far,         ///< a capsule is further than 1000 km from the map's origin
};
struct PostureFault {
    PostureError error = PostureError::wrong_count;
    std::size_t joint = 0;
};

/// The robot's body from the rig, for queries to a map. Immutable: any thread may use it.
class RobotQuery {
  public:
    [[nodiscard]] static Result<RobotQuery, RobotQueryFault> build(const HostRig& rig,
                                                                   const RobotModel& robot,
                                                                   const RobotQueryConfig& config = {});

    /// The capsules of the query in the map frame. `position` as for RobotModel. About 2 us.
    [[nodiscard]] Result<std::vector<PosedCapsule>, PostureFault> pose(
        std::span<const double> position) const;
    [[nodiscard]] std::optional<PostureFault> fault_of(std::span<const double> position) const noexcept;
    /// The same for a position that is valid, or that is only beyond its limits.
    [[nodiscard]] std::vector<PosedCapsule> posed(std::span<const double> position) const;
    /// Upper bound of the distance from an end of a capsule's axis to the axis of a joint that turns it: see
    /// RobotModel::levers_m.
    [[nodiscard]] double lever_m(std::span<const double> farthest) const;

    [[nodiscard]] const RobotModel& robot() const noexcept { return robot_; }
    /// May be 0 if the robot has unknown links.
    [[nodiscard]] std::size_t capsule_count() const noexcept { return capsules_; }
    /// The links whose bodies the query covers, each once, by LinkId.
    [[nodiscard]] std::vector<LinkId> links() const;
    /// Links that a joint moves, that have a <visual> but no body, and that the rig does not list as
    /// intended. Their space is not known, so no posture of this robot is free. Leaving out bodies from a
    /// query does not change this.
    [[nodiscard]] std::span<const LinkId> unknown_links() const noexcept { return unknown_links_; }
    [[nodiscard]] const Eigen::Isometry3d& T_map_base() const noexcept { return T_map_base_; }

  private:
    RobotQuery(const RobotModel& robot, RobotBody body, std::vector<LinkId> unknown_links,
               const Eigen::Isometry3d& T_map_base, std::size_t capsules, double padding_m);

    RobotModel robot_;
    RobotBody body_;
    std::vector<LinkId> unknown_links_;
    Eigen::Isometry3d T_map_base_;
    std::size_t capsules_;
    double padding_m_;
};

/// The weakest evidence of a posture.
struct PostureEvidence {
    WeakestEvidence weakest;
    LinkId link = {};  ///< the link that touches it; of several the first
};

/// The weakest evidence of capsules from RobotQuery, in a map with ages. Empty without ages, and if no known
/// voxel is touched. `than`: the result of other postures. About 5 us per capsule at 0.04 m.
[[nodiscard]] std::optional<PostureEvidence> weakest_of(const FusedMap& map,
                                                        std::span<const PosedCapsule> capsules,
                                                        std::optional<PostureEvidence> than = {}) noexcept;

/// The free voxel with the least evidence that a posture touches.
struct PostureFree {
    WeakestFree weakest;
    LinkId link = {};  ///< the link that touches it; of several the first
};
/// Empty if the capsules, which are from RobotQuery, touch no free voxel. `than`: the result of other
/// postures. About 5 us per capsule at 0.04 m.
[[nodiscard]] std::optional<PostureFree> weakest_free_of(const FusedMap& map, const MissUnits& units,
                                                         std::span<const PosedCapsule> capsules,
                                                         std::optional<PostureFree> than = {}) noexcept;

/// The result for capsules from `robot`; a capsule that is too large is refused. The age of evidence does not
/// change an occupied voxel. If the robot has an unknown link, the answer is unknown at best, with that link
/// if no capsule touches an unknown or occupied voxel. So is it if a free voxel does not meet the demand.
/// About 4 us per capsule at 0.04 m, with a demand 9 us.
[[nodiscard]] Result<PostureAnswer, RefusedCapsule> worst_of(const RobotQuery& robot, const FusedMap& map,
                                                             std::span<const PosedCapsule> capsules,
                                                             const FreeDemand& demand = {}) noexcept;
/// The least clearance up to `reach_m` from the surface of each capsule. `than`: the result of other
/// postures; the answer is the least of all, and greater distances are not searched.
[[nodiscard]] Result<PostureClearance, RefusedCapsule> clearance_of(
    const FusedMap& map, std::span<const PosedCapsule> capsules, double reach_m,
    const PostureClearance& than = {}) noexcept;
/// The same for a field's map.
[[nodiscard]] Result<PostureClearance, RefusedCapsule> clearance_of(
    const DistanceField& field, std::span<const PosedCapsule> capsules, double reach_m,
    const PostureClearance& than = {}) noexcept;
/// The same up to the field's limit.
[[nodiscard]] Result<PostureClearance, RefusedCapsule> clearance_of(
    const DistanceField& field, std::span<const PosedCapsule> capsules) noexcept;

}  // namespace octoskin
