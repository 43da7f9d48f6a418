// Finds the voxels that one placed range of a sensor with a cone-shaped field of view is about.
#pragma once

#include <cstdint>
#include <optional>

#include "common/result.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/mapping/beam_rejection.hpp"
#include "host/core/mapping/cone_size.hpp"
#include "host/core/mapping/cone_voxels.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// How far off the axis a range marks voxels occupied.
enum class CapWidth : std::uint8_t {
    whole,  ///< as the model defines
    core,   ///< only within the angle in which it frees space; cap voxels beyond have no weight
};

/// Finds the voxels of ranges, one after the other. Reuses its memory; not for concurrent use by two threads.
class ConeFinder {
  public:
    explicit ConeFinder(const MappingConfig& config);

    /// The voxels of a beam whose optics are a cone (asserted), by the parameters for these optics
    /// (`model_of`). Valid until the next call. For a beam without return: the passed voxels up to the
    /// smaller of `MappingConfig::no_return_clear_m` and the beam's limit. Voxels outside the octree are
    /// omitted; more than `kConeVoxelsMax` are refused. O(voxels); about 3 us at 1 m and 0.04 m. Throws
    /// std::bad_alloc.
    [[nodiscard]] Result<const ConeVoxels*, BeamRejection> find(const Beam& beam,
                                                                CapWidth width = CapWidth::whole);
    /// The reason why `find` refuses a beam, for any width; empty if it does not. O(1).
    [[nodiscard]] std::optional<BeamRejection> refusal_of(const Beam& beam) const noexcept;
    /// Length of the beam, metres: its range or, without a range, how far it may free space.
    [[nodiscard]] double length_m(const Beam& beam) const noexcept { return cone_length_m(beam, config_); }
    /// True if a voxel touches the cap of a beam with a range. Approximate: uses the voxel's centre and half
    /// its edge. Works for any range.
    [[nodiscard]] bool ends_about(const Beam& beam, VoxelKey key) const noexcept;
    [[nodiscard]] const VoxelLattice& lattice() const noexcept { return lattice_; }
    /// The parameters with which its voxels are found and counted.
    [[nodiscard]] const ConeModel& model_of(const Beam& beam) const noexcept {
        return config_.cone_of(beam.optics);
    }

  private:
    /// Limits of the passed voxels: length, angle, margin.
    struct Passed {
        double end_m = 0.0;
        double tan_core = 0.0;
        double margin_m = 0.0;
    };
    struct Cap {
        double range_m = 0.0;
        double half_thickness_m = 0.0;
        double angle_rad = 0.0;
        double middle_rad = 0.0;
        double marks_rad = 0.0;  ///< cap voxels beyond have no weight
    };
    void find_passed(const Beam& beam, const Passed& passed);
    void find_cap(const Beam& beam, const Cap& cap);

    MappingConfig config_;
    VoxelLattice lattice_;
    ConeVoxels voxels_;
};

}  // namespace octoskin
