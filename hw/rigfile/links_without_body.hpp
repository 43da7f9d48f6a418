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

/// By name, each link at or below `rig.base_link` that a joint moves, that has a <visual>, and that is
/// without a capsule of `body` on it or on any link that is rigidly attached to it: by fixed joints alone,
/// above or below. Whether the capsules there are are large enough is not looked at, and a link that has
/// neither <visual> nor body is taken for a frame. Errors: those of the URDF. O(links log links).
[[nodiscard]] Result<std::vector<std::string>, RigError> links_without_body(const Rig& rig,
                                                                            std::span<const Capsule> body);

}  // namespace octoskin::rig
