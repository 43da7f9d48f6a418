// Points spread over a surface.
#pragma once

#include <vector>

#include "host/core/body_fit/fit_work.hpp"
#include "host/core/body_fit/surface_mesh.hpp"

namespace octoskin {

/// Points of the surface, one in each cube of `spacing_m` that holds one of the points tried: the vertices,
/// and a grid of at most that spacing on each triangle. In the order of the triangles.
/// `work` ends it early.
[[nodiscard]] std::vector<Eigen::Vector3d> spread_points(const SurfaceMesh& mesh, double spacing_m,
                                                         FitWork* work = nullptr);

}  // namespace octoskin
