// Links of the robot that move and can be seen, but that have no body: nothing of them is taken out of images
// and ranges, and no question about the robot's body tells of them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/robot_description.hpp"

namespace octoskin::rig {

/// A link without a capsule of its own, for which the body of a link that is fixed to it stands.
struct BorrowedBody {
    std::string link;
    std::string body_of;  ///< of the links that lend one, that with the longest capsule

    bool operator==(const BorrowedBody&) const = default;
};

/// Links at or below the base link that a joint moves and that have a <visual>, each at most once.
struct BodylessLinks {
    std::vector<std::string> without_body;  ///< by name
    std::vector<BorrowedBody> borrowed;     ///< by name of the link
};

/// Links between which there are fixed joints alone have one body together: the capsules of `body` on them.
/// It counts if all of this holds:
/// - Half of the length of their <visual>s has a capsule beside it that reaches into that <visual>. Lengths
///   are the longest sides of boxes, spheres and cylinders, summed over the hundred longest.
/// - If a <visual> is a mesh: half of the shortest line from the axis that turns them to each axis that they
///   carry has one beside it.
/// - If a link has a mesh for a <visual> and no capsule of its own: some capsule is 5 cm long, and a fifth of
///   the line from the joint that turns them to each turning joint that they carry has one beside it.
///
/// Where it does not count, each of them that has a <visual> is without a body, but those whose <visual>s are
/// all of known size and half beside the capsules of the link itself. A link that has neither <visual> nor
/// body is taken for a frame. Meshes are not read. Errors: those of the URDF. O(links log links + capsules
/// log capsules), a hundred times that at worst.
[[nodiscard]] Result<BodylessLinks, RigError> bodyless_links(const Rig& rig, std::span<const Capsule> body);

}  // namespace octoskin::rig
