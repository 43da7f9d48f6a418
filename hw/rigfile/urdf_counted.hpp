// What of a robot description counts, as a URDF of its own: urdfdom refuses a robot for what octoskin does
// not use, too.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace tinyxml2 {
class XMLElement;
}

namespace octoskin::rig {

/// Printed anew, of elements and attributes alone: what two XML readers read alike. urdfdom's ends an XML
/// declaration elsewhere, and would read another robot out of the file than was looked at here.
///
/// Links with their <visual> and <collision>, joints with what places and moves them; without <inertial>,
/// materials, transmissions and whatever else there is. A <visual> whose size or place cannot be read, and a
/// mesh, is a mesh without a size. `robot`: that UrdfOutline has read; what does not count is taken out of
/// it. A <capsule> in a <collision> is a <cylinder> of its radius and length. Errors, with the line: what
/// counts has a xacro expression or element left in it; a <collision> of a shape that is none of box, sphere,
/// cylinder, capsule and mesh, or a capsule without its numbers, all links in one. `file` is for the messages
/// only.
[[nodiscard]] Result<std::string, RigError> counted_urdf(const std::filesystem::path& file,
                                                         tinyxml2::XMLElement& robot);

}  // namespace octoskin::rig
