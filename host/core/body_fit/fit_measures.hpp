// How closely capsules follow a surface.
#pragma once

#include <optional>
#include <span>

#include "host/core/body_fit/convex_hull.hpp"
#include "host/core/body_fit/mesh_distance.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

struct FitMeasures {
    /// Volume of the set outside the convex hull, by the volume of the hull; none for a flat mesh.
    std::optional<double> excess_ratio;
    /// Distance of the set's outer surface from the mesh, weighted by area, metres.
    double protrusion_p95_m = 0.0;
    double protrusion_p99_m = 0.0;
    double protrusion_max_m = 0.0;
};

/// By points at fixed places: 4 mm apart on a capsule of up to a square metre, and 8,000 rows through the
/// set.
[[nodiscard]] FitMeasures measure(std::span<const PosedCapsule> capsules, const MeshDistance& distance,
                                  const ConvexHull* hull);

}  // namespace octoskin
