#include "host/core/body_fit/fit_capsules.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>
#include <utility>

#include "host/core/body_fit/body_search.hpp"
#include "host/core/body_fit/bounding_box.hpp"
#include "host/core/body_fit/coverage.hpp"
#include "host/core/body_fit/spread_points.hpp"

namespace octoskin {
namespace {

constexpr double kExcessSmall = 0.08;  ///< of the hull's volume, weighted: more capsules are not worth it
constexpr double kExcessMost = 0.42;
constexpr double kHullFlat_m = 1e-4;  ///< the hull only measures
constexpr double kProtrusionP99Most_m = 0.029;
constexpr double kProtrusionMost_m = 0.048;

/// The worst measure by its limit: at most 1 if all are kept.
double badness(const FitMeasures& measures) {
    return std::max({measures.excess_ratio.value_or(0.0) / kExcessMost,
                     measures.protrusion_p99_m / kProtrusionP99Most_m,
                     measures.protrusion_max_m / kProtrusionMost_m});
}

class LinkFit {
  public:
    explicit LinkFit(const SurfaceMesh& mesh)
        : mesh_(mesh),
          diagonal_m_(box_of(mesh).diagonal().norm()),
          distance_(mesh, &work_),
          hull_(ConvexHull::around(mesh.vertices, kHullFlat_m, &work_)),
          field_(mesh, distance_, hull_ ? &*hull_ : nullptr),
          search_(points_of(mesh), field_) {}

    std::optional<BodyFit> run() {
        if (work_.is_spent()) return std::nullopt;
        split_up_to_few();
        try_groups();
        for (const std::size_t rank : {0U, 1U, 2U, 0U}) search_.exchange(rank);
        BodyFit best = finished();
        for (const std::size_t count : kManyCounts) {
            if (work_.is_spent() || badness(best.measures) <= 1.0) break;
            search_.regroup(count);
            search_.refine(4, 12);
            BodyFit next = finished();
            if (badness(next.measures) < badness(best.measures)) best = std::move(next);
        }
        if (work_.is_spent()) return std::nullopt;
        best.work = work_.used();
        return best;
    }

  private:
    static constexpr std::array<std::size_t, 4> kManyCounts{12, 16, 24, kCapsulesMost};
    static constexpr double kSpacingMin_m = 0.0015;
    static constexpr double kPointsAcross = 60.0;

    /// The search takes time for each point and capsule; a surface has about 10,000 points.
    std::vector<Eigen::Vector3d> points_of(const SurfaceMesh& mesh) {
        constexpr std::size_t kPointsMost = 60'000;
        auto points = spread_points(mesh, std::max(kSpacingMin_m, diagonal_m_ / kPointsAcross), &work_);
        if (points.size() > kPointsMost) work_.spend_all();
        if (work_.is_spent()) points.resize(1);
        return points;
    }

    void split_up_to_few() {
        while (search_.capsules().size() < kCapsulesFew) {
            search_.refine(2, 12);
            const double excess_m3 = search_.excess() * field_.voxel_m3();
            if (hull_ && excess_m3 < kExcessSmall * hull_->volume_m3()) return;
            if (!search_.split()) return;
        }
        search_.refine(4, 12);
    }

    /// Groups of points may lead to a better set than splits.
    void try_groups() {
        constexpr std::array<std::size_t, 3> kCounts{5, 6, kCapsulesFew};
        auto best = search_.capsules();
        double least = search_.excess();
        for (const std::size_t count : kCounts) {
            search_.regroup(count);
            search_.refine(4, 12);
            const double excess = search_.excess();
            if (!(excess < least)) continue;
            least = excess;
            best = search_.capsules();
        }
        search_.set_capsules(std::move(best));
    }

    [[nodiscard]] BodyFit finished() {
        constexpr double kEdgeMin_m = 0.001;
        constexpr double kEdgesAcross = 1000.0;
        BodyFit fit{.capsules = search_.capsules(), .measures = {}};
        grow_to_cover(mesh_, fit.capsules, kCoveredWithin_m, std::max(kEdgeMin_m, diagonal_m_ / kEdgesAcross),
                      &work_);
        if (work_.is_spent()) return fit;
        fit.measures = measure(fit.capsules, distance_, hull_ ? &*hull_ : nullptr);
        return fit;
    }

    const SurfaceMesh& mesh_;
    FitWork work_;
    double diagonal_m_;
    MeshDistance distance_;
    std::optional<ConvexHull> hull_;
    ExcessField field_;
    BodySearch search_;
};

}  // namespace

std::optional<BodyFit> fit_capsules(const SurfaceMesh& mesh) {
    assert(!mesh.triangles.empty());
    return LinkFit(mesh).run();
}

}  // namespace octoskin
