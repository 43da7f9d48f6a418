// The name under which the fit of a robot is kept: it changes with each byte that the fit depends on.
#pragma once

#include <string>

#include "common/result.hpp"
#include "host/io/robot/mesh_places.hpp"
#include "hw/rigfile/link_shapes.hpp"

namespace octoskin {

/// 32 hexadecimal digits of the URDF's bytes, the base link, the bytes of each mesh that fit_robot() would
/// read, and the version of the fit. Two FNV-1a hashes: against files that differ by chance, not by an
/// attack. Errors: a mesh that cannot be found or read, with the URDF's line.
[[nodiscard]] Result<std::string, Error> fit_key(const FilePlace& urdf, const rig::RobotShapes& shapes,
                                                 const MeshSearch& search);

}  // namespace octoskin
