// Fits capsules to the surface of a link.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/body_fit/fit_measures.hpp"
#include "host/core/body_fit/surface_mesh.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// Each point of the surface is at most this far outside of the capsules.
inline constexpr double kCoveredWithin_m = 0.002;
/// Capsules of a link, and the most for one that so few do not fit.
inline constexpr std::size_t kCapsulesFew = 8;
inline constexpr std::size_t kCapsulesMost = 32;

struct BodyFit {
    std::vector<PosedCapsule> capsules;  ///< in the mesh's frame
    FitMeasures measures;
    std::uint64_t work = 0;  ///< of FitWork::kMost
};

/// Capsules that cover the surface within kCoveredWithin_m, which first_uncovered() (coverage.hpp) confirms.
/// At most kCapsulesFew, unless these exceed 42 % of the hull's volume outside of it, or 29 mm from the mesh
/// on more than 1 % of their outer surface, or 48 mm anywhere: then 12, 16, 24 or kCapsulesMost, the first
/// number that keeps these limits, or the best one. None if that needs more work than FitWork::kMost, about
/// ten seconds, as for many large triangles that cross. `mesh` has a triangle; all coordinates are finite.
/// The same result on each processor for one build. About a second for a link of 30,000 triangles.
[[nodiscard]] std::optional<BodyFit> fit_capsules(const SurfaceMesh& mesh);

}  // namespace octoskin
