// Target of evidence: one map, or several at once.
#pragma once

#include <functional>

#include "host/core/mapping/evidence.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

class EvidenceSink {
  public:
    virtual ~EvidenceSink() = default;
    /// Takes the evidence of one measurement, one after the other. `spares`: see EvidenceOptions; may be
    /// null.
    virtual void apply(const Evidence& evidence, const std::function<bool(VoxelKey)>* spares) = 0;
    /// True if a voxel is occupied now, in all maps.
    [[nodiscard]] virtual bool is_occupied(VoxelKey key) const = 0;
};

}  // namespace octoskin
