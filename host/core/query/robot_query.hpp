// A planner's question about the whole robot: may it stand so, and what is the nearest thing in its way?
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
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The later one is the worse.
enum class PostureState : std::uint8_t {
    free,
    stale,  ///< nothing worse, but free space that no sensor has confirmed for `age.stale_after_s`
    unknown,
    occupied,
};
[[nodiscard]] std::string_view name(PostureState state) noexcept;

/// What is in the way of a robot that stands so.
struct PostureAnswer {
    PostureState state = PostureState::free;
    /// Of the links in that state the one that reaches furthest into it; empty for free.
    std::optional<LinkId> link;
    /// The voxel that is nearest to the axis of that link's body, if it is stale the one with the weakest
    /// evidence; empty for free, outside the octree, and if that link has no body.
    std::optional<VoxelKey> voxel;
};

/// How far the robot's surface, padding included, is from the nearest voxel; 0 if it touches one. Of the
/// bodies that are asked about: links without a body may be nearer, and then it is an upper bound.
struct PostureClearance {
    std::optional<double> occupied_m;  ///< empty: beyond the reach
    std::optional<double> not_free_m;
    std::optional<LinkId> occupied_link;  ///< which is that near
    std::optional<LinkId> not_free_link;
};

struct RobotQueryConfig {
    double padding_m = 0.0;  ///< added to the radius of each capsule; 0 to 1 (else `bad_padding`)
    /// Links that are not asked about, by name.
    std::vector<std::string> links_ignored = {};
    /// Capsules that no joint moves, such as the base's, are where they are in every posture, and what they
    /// stand on they touch.
    bool ignores_unmoved = true;
    /// HostRig::certain_body in place of the body: to know what is the robot for sure, not to ask about it.
    bool is_of_certain_body = false;
};

enum class RobotQueryError : std::uint8_t {
    unknown_link,  ///< `links_ignored` names, or the rig has a body on, a link that the robot does not have
    bad_padding,
    no_body,  ///< nothing is left to ask about, and no link is unknown: every answer would be "free"
};
struct RobotQueryFault {
    RobotQueryError error = RobotQueryError::unknown_link;
    std::string element;  ///< the link
};

enum class PostureError : std::uint8_t {
    wrong_count,  ///< of joint positions
    not_finite,
    outside_limits,  ///< of the joint, by more than 0.005 (rad or m), as joint samples may be
    too_far,         ///< a capsule is further than 1000 km from the map's origin
};
struct PostureFault {
    PostureError error = PostureError::wrong_count;
    std::size_t joint = 0;
};

/// The robot's body as the rig has it, and the questions that it puts to a map. Never changes: any thread.
class RobotQuery {
  public:
    [[nodiscard]] static Result<RobotQuery, RobotQueryFault> build(const HostRig& rig,
                                                                   const RobotModel& robot,
                                                                   const RobotQueryConfig& config = {});

    /// The capsules that are asked about, in the map frame. `position` as RobotModel's. About 2 us.
    [[nodiscard]] Result<std::vector<PosedCapsule>, PostureFault> pose(
        std::span<const double> position) const;
    [[nodiscard]] std::optional<PostureFault> fault_of(std::span<const double> position) const noexcept;
    /// The same of a position that is no fault, or only by its limits.
    [[nodiscard]] std::vector<PosedCapsule> posed(std::span<const double> position) const;
    /// No end of a capsule's axis is ever further from the axis of a joint that turns it: see
    /// RobotModel::levers_m.
    [[nodiscard]] double lever_m(std::span<const double> farthest) const;

    [[nodiscard]] const RobotModel& robot() const noexcept { return robot_; }
    /// May be 0, if the robot has links that are unknown.
    [[nodiscard]] std::size_t capsule_count() const noexcept { return capsules_; }
    /// The links whose bodies are asked about, each once, by LinkId.
    [[nodiscard]] std::vector<LinkId> links() const;
    /// Links that a joint moves, that have a <visual> and no body, and that the rig does not list as such on
    /// purpose: where they are is not known, so that no posture of this robot is free. Which bodies a
    /// question leaves out changes nothing about it.
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

/// What a posture's answer rests on.
struct PostureEvidence {
    WeakestEvidence weakest;
    LinkId link = {};  ///< that touches it; of several the first
};

/// Of capsules that RobotQuery posed, in a map that tells ages; empty of one that does not, and where nothing
/// known is touched. `than`: of other postures. About 5 us a capsule at 0.04 m.
[[nodiscard]] std::optional<PostureEvidence> weakest_of(const FusedMap& map,
                                                        std::span<const PosedCapsule> capsules,
                                                        std::optional<PostureEvidence> than = {}) noexcept;

/// Of capsules that `robot` posed; too large a robot is refused. An occupied voxel is occupied however old
/// its evidence is. Unknown at best if the robot has a link that is unknown: that is then the answer's, if
/// none of the capsules touches anything unknown or occupied. About 4 us a capsule at 0.04 m.
[[nodiscard]] Result<PostureAnswer, RefusedCapsule> worst_of(const RobotQuery& robot, const FusedMap& map,
                                                             std::span<const PosedCapsule> capsules) noexcept;
/// Up to `reach_m` from the surface of each capsule. `than`: of other postures; the answer is the least of
/// all, and what is further away is not looked for.
[[nodiscard]] Result<PostureClearance, RefusedCapsule> clearance_of(
    const FusedMap& map, std::span<const PosedCapsule> capsules, double reach_m,
    const PostureClearance& than = {}) noexcept;
/// The same of a field's map.
[[nodiscard]] Result<PostureClearance, RefusedCapsule> clearance_of(
    const DistanceField& field, std::span<const PosedCapsule> capsules, double reach_m,
    const PostureClearance& than = {}) noexcept;
/// As far as it tells.
[[nodiscard]] Result<PostureClearance, RefusedCapsule> clearance_of(
    const DistanceField& field, std::span<const PosedCapsule> capsules) noexcept;

}  // namespace octoskin
