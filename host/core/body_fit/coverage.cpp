#include "host/core/body_fit/coverage.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace octoskin {
namespace {

/// The radius that the capsule needs to contain the piece, beyond its own.
double lacking_m(const PosedCapsule& capsule, const Triangle& piece) {
    return std::max({distance_to_surface(capsule, piece[0]), distance_to_surface(capsule, piece[1]),
                     distance_to_surface(capsule, piece[2])});
}

/// The corner from which the longest edge runs to the next one.
std::size_t longest_edge(const Triangle& piece, double& length_m) {
    std::size_t longest = 0;
    double square = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double other = (piece[(i + 1) % 3] - piece[i]).squaredNorm();
        if (other > square) {
            square = other;
            longest = i;
        }
    }
    length_m = std::sqrt(square);
    return longest;
}

/// Calls `on_uncovered` with each piece that is in no capsule and too short to be cut. It may enlarge
/// capsules; returning false ends the walk, and so does `work`.
template <typename OnUncovered>
void walk(const SurfaceMesh& mesh, std::span<const PosedCapsule> capsules, double grown_m, double edge_m,
          FitWork* work, OnUncovered&& on_uncovered) {
    std::size_t last = 0;          // neighbouring pieces are mostly in the same capsule
    std::vector<Triangle> pieces;  // at most one for each halving of an edge
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        pieces.push_back(mesh.corners(i));
        while (!pieces.empty()) {
            const Triangle piece = pieces.back();
            pieces.pop_back();
            if (work != nullptr && !work->spend(1 + capsules.size() / 4)) return;
            const auto holds = [&](const PosedCapsule& capsule) {
                return lacking_m(capsule, piece) <= grown_m;
            };
            if (last < capsules.size() && holds(capsules[last])) continue;
            const auto found = std::ranges::find_if(capsules, holds);
            if (found != capsules.end()) {
                last = static_cast<std::size_t>(found - capsules.begin());
                continue;
            }
            double length_m = 0.0;
            const std::size_t from = longest_edge(piece, length_m);
            if (length_m <= edge_m) {
                if (!on_uncovered(piece)) return;
                continue;
            }
            const std::size_t to = (from + 1) % 3;
            const Eigen::Vector3d middle = 0.5 * (piece[from] + piece[to]);
            Triangle half = piece;
            half[to] = middle;
            pieces.push_back(half);
            half = piece;
            half[from] = middle;
            pieces.push_back(half);
        }
    }
}

}  // namespace

std::optional<Triangle> first_uncovered(const SurfaceMesh& mesh, std::span<const PosedCapsule> capsules,
                                        double grown_m, double edge_m) {
    std::optional<Triangle> found;
    walk(mesh, capsules, grown_m, edge_m, nullptr, [&](const Triangle& piece) {
        found = piece;
        return false;
    });
    return found;
}

void grow_to_cover(const SurfaceMesh& mesh, std::vector<PosedCapsule>& capsules, double grown_m,
                   double edge_m, FitWork* work) {
    assert(!capsules.empty());
    constexpr double kMore_m = 1e-9;
    walk(mesh, capsules, grown_m, edge_m, work, [&](const Triangle& piece) {
        const auto nearest = std::ranges::min_element(
            capsules, {}, [&](const PosedCapsule& capsule) { return lacking_m(capsule, piece); });
        nearest->radius_m += std::max(0.0, lacking_m(*nearest, piece) - grown_m) + kMore_m;
        return true;
    });
}

}  // namespace octoskin
