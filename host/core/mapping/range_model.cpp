#include "host/core/mapping/range_model.hpp"

#include "host/core/mapping/cone_evidence.hpp"

namespace octoskin {

Status<BeamRejection> RangeModel::integrate_ray(const Beam& beam, EvidenceSink& sink) {
    const auto evidence = ray_.find(beam);
    if (!evidence) return unexpected(evidence.error());
    sink.apply((*evidence)->terms, nullptr);
    if (!(*evidence)->weakened.empty()) sink.apply((*evidence)->weakened, nullptr);
    if (sees_any_cone_) stationary_.take_ray(beam);
    return Done{};
}

Status<BeamRejection> RangeModel::integrate_cone(const Beam& beam, EvidenceSink& sink) {
    // Checked before the beam is taken: a refused beam is in no recording, and must have no effect.
    if (const auto refusal = cone_.refusal_of(beam)) return unexpected(*refusal);
    const ConfirmedRanges::Answer answer = stationary_.take(beam);
    const auto voxels = cone_.find(beam, width_of(answer));
    if (!voxels) return unexpected(voxels.error());
    make_counts(**voxels, cone_.model_of(beam), answer.repeats_confirmed, counts_);
    sink.apply(counts_, nullptr);
    stationary_.conclude(beam, answer, sink);
    return Done{};
}

}  // namespace octoskin
