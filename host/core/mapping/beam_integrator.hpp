// From one placed range to the log-odds terms of its voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "common/result.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

/// Why a beam was refused.
enum class BeamRejection : std::uint8_t {
    origin_not_finite,
    direction_not_unit,  ///< not finite, or its length differs from 1 by more than 1e-6
    range_not_valid,     ///< not finite, or negative
    limit_not_valid,     ///< the clearing limit is not finite, or negative
    outside_map,         ///< origin or endpoint lies outside the octree
};

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
