// The shapes of an SDF file as triangle meshes.
#pragma once

#include <sdf/Geometry.hh>
#include <string>

#include "common/result.hpp"
#include "hw/sim/world/sdf/sdf_module.hpp"
#include "hw/sim/world/solid.hpp"

namespace octoskin::sim {

/// For messages: the shapes that mesh_of() supports.
inline constexpr const char* kSdfShapes =
    "box, cylinder, sphere, capsule, ellipsoid, plane, mesh (a cone is a mesh)";

/// The shape in its own coordinates, metres. Errors: another shape, a size that is not positive and finite, a
/// mesh that cannot be read, or that `world` may not refer to.
[[nodiscard]] Result<TriangleMesh, std::string> mesh_of(const sdf::Geometry& geometry, const SdfInput& world);

}  // namespace octoskin::sim
