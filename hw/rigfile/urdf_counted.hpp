// Reduces a robot description to the elements that octoskin uses: urdfdom also refuses a robot for errors in
// other elements.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "hw/rigfile/rig.hpp"

namespace tinyxml2 {
class XMLElement;
}

namespace octoskin::rig {

/// Prints a new URDF of elements and attributes only, which both XML readers read alike. urdfdom's reader
/// ends an XML declaration at another place, and would read a different robot from the original file than was
/// checked here.
///
/// Links with their <visual> and <collision>, joints with what places and moves them; without <inertial>,
/// materials, transmissions and all other elements. A mesh, and a <visual> whose size or place cannot be
/// read, becomes a mesh without a size. `robot`: the document that UrdfOutline has read; unused elements are
/// removed from it. A <capsule> in a <collision> is a <cylinder> of its radius and length. Errors, with the
/// line: a used element contains a xacro expression or element; a <collision> of a shape that is none of box,
/// sphere, cylinder, capsule and mesh, or a capsule without its numbers (all links in one error). `file` is
/// for the messages only.
[[nodiscard]] Result<std::string, Error> counted_urdf(const std::filesystem::path& file,
                                                      tinyxml2::XMLElement& robot);

}  // namespace octoskin::rig
