// Reads the sources of joint states of a rig file.
#pragma once

#include <vector>

#include "hw/rigfile/document.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/rigfile/urdf_document.hpp"

namespace octoskin::rig {

/// `joints` of a rig: one source, or a list of them. `rig`: has its base link and nodes. Throws Error: a key,
/// a type, a range, an id that another has, a joint that is unknown, in two places or in none, too many
/// joints.
[[nodiscard]] std::vector<JointSource> read_joint_sources(const Value& value, const UrdfDocument& robot,
                                                          const Rig& rig);

}  // namespace octoskin::rig
