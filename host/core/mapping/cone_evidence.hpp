// What the voxels of a cone's range are evidence of. All take the place of what `evidence` holds, keep its
// memory, and throw std::bad_alloc; some 2 ns a voxel.
#pragma once

#include "host/core/mapping/cone_model.hpp"
#include "host/core/mapping/cone_voxels.hpp"
#include "host/core/mapping/evidence.hpp"

namespace octoskin {

/// Hits for the cap, misses for what was passed. `prefers_occupied`: see Evidence.
void make_counts(const ConeVoxels& cone, const ConeModel& model, bool prefers_occupied, Evidence& evidence);
/// The middle is occupied, with at least so many hits, unless something in the cap is.
void make_confirmation(const ConeVoxels& cone, float hits, Evidence& evidence);
/// The cap's hits mark nothing.
void make_withdrawal(const ConeVoxels& cone, Evidence& evidence);
/// What was passed is free.
void make_clearance(const ConeVoxels& cone, Evidence& evidence);

}  // namespace octoskin
