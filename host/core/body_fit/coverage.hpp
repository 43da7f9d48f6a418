// The proof that capsules cover a surface.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/core/body_fit/fit_work.hpp"
#include "host/core/body_fit/surface_mesh.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// Cuts each triangle in halves until each piece lies in one of the capsules grown by `grown_m`. That proves
/// that the capsules cover it: a capsule is convex, so it contains a piece if it contains its three corners.
/// Returns the first piece with edges of at most `edge_m` that is in none; empty if all are covered.
[[nodiscard]] std::optional<Triangle> first_uncovered(const SurfaceMesh& mesh,
                                                      std::span<const PosedCapsule> capsules, double grown_m,
                                                      double edge_m);

/// Enlarges radii until first_uncovered() finds none: a piece with edges of at most `edge_m` that no capsule
/// contains enlarges the one that needs the least. `work` ends it early.
void grow_to_cover(const SurfaceMesh& mesh, std::vector<PosedCapsule>& capsules, double grown_m,
                   double edge_m, FitWork* work = nullptr);

}  // namespace octoskin
