// Links of the robot that move and are visible but have no body: the self-filter does not remove them from
// images and ranges, and queries about the robot's body do not include them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"

namespace octoskin::rig {

/// A link without its own capsule that is represented by the body of a link fixed to it.
struct BorrowedBody {
    std::string link;
    std::string body_of;  ///< of the links with a body, the one with the longest capsule

    bool operator==(const BorrowedBody&) const = default;
};

/// Links at or below the base link that a joint moves and that have a <visual>, each at most once.
struct BodylessLinks {
    std::vector<std::string> without_body;  ///< by name
    std::vector<BorrowedBody> borrowed;     ///< by name of the link
};

/// Links that are connected by fixed joints only have one common body: the capsules of `body` on them. It is
/// accepted if all of these conditions hold:
/// - Half of the length of their <visual>s is covered by a capsule beside it that reaches into that <visual>.
/// Lengths are the longest sides of boxes, spheres and cylinders, summed over the hundred longest.
/// - If a <visual> is a mesh: half of the shortest line from the axis that turns them to each axis that they
/// carry is covered by a capsule.
/// - If a link has a mesh for a <visual> and no capsule of its own: some capsule is 5 cm long, and a fifth of
/// the line from the joint that turns them to each turning joint that they carry is covered by a capsule.
///
/// If it is not accepted, each of the links with a <visual> is reported as without a body, except a link
/// whose <visual>s all have a known size and are half covered by the link's own capsules. A link with neither
/// <visual> nor body is treated as a frame. Meshes are not read. Errors: those of the URDF. O(links log links
/// + capsules log capsules), a hundred times that at worst.
[[nodiscard]] Result<BodylessLinks, Error> bodyless_links(const Rig& rig, std::span<const Capsule> body);

}  // namespace octoskin::rig
