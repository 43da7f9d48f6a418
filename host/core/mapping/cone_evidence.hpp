// Converts the voxels of a cone's range to evidence. All functions replace the contents of `evidence`, keep
// its memory, and throw std::bad_alloc; about 2 ns a voxel.
#pragma once

#include "host/core/mapping/cone_model.hpp"
#include "host/core/mapping/cone_voxels.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

/// Hits for the cap, misses for the passed voxels. `prefers_occupied`: see Evidence.
void make_counts(const ConeVoxels& cone, const ConeModel& model, bool prefers_occupied, Evidence& evidence);
/// The middle becomes occupied, with at least `hits` hits, unless a voxel of the cap is occupied.
void make_confirmation(const ConeVoxels& cone, float hits, Evidence& evidence);
/// Cap voxels that are not occupied lose their hits.
void make_withdrawal(const ConeVoxels& cone, Evidence& evidence);
/// The passed voxels become free.
void make_clearance(const ConeVoxels& cone, Evidence& evidence);

}  // namespace octoskin
