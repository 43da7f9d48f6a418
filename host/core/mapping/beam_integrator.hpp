// From one placed range to the log-odds terms of its voxels.
#pragma once

#include <vector>

#include "common/result.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/mapping/beam_rejection.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

/// Stateless after construction; may be shared by threads.
class BeamIntegrator {
  public:
    explicit BeamIntegrator(const MappingConfig& config);

    /// A beam with a range: one miss for each voxel it passes through, from the sensor on, then the hit term
    /// for its range at the endpoint's voxel (left out if 0). A beam without: one miss for each voxel up to
    /// the smaller of `MappingConfig::no_return_clear_m` and the beam's own `clear_limit_m`, and never a hit;
    /// nothing if either is 0. O(range / resolution), about 1 us at 4 m and 0.04 m.
    [[nodiscard]] Result<std::vector<VoxelUpdate>, BeamRejection> integrate(const Beam& beam) const;

  private:
    UpdateModel model_;
    double no_return_clear_m_;
    VoxelLattice lattice_;
};

}  // namespace octoskin
