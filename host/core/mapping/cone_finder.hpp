// From one placed range of a sensor that sees a cone to the voxels of which it speaks.
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

/// How far off the axis a range marks.
enum class CapWidth : std::uint8_t {
    whole,  ///< as the model says
    core,   ///< and no further than where it would free space: beyond, voxels of the cap have no weight
};

/// The voxels of ranges, one after the other. Keeps its memory; not for two threads at once.
class ConeFinder {
  public:
    explicit ConeFinder(const MappingConfig& config);

    /// The voxels of a beam whose optics are a cone (asserted), by the parameters for these optics
    /// (`model_of`); valid until the next call. Without return:
    /// what is passed up to the smaller of `MappingConfig::no_return_clear_m` and the beam's limit. What lies
    /// outside the octree is left out; more than `kConeVoxelsMax` are refused. O(voxels); about 3 us at 1 m
    /// and 0.04 m. Throws std::bad_alloc.
    [[nodiscard]] Result<const ConeVoxels*, BeamRejection> find(const Beam& beam,
                                                                CapWidth width = CapWidth::whole);
    /// Why `find` refuses a beam, of whatever width; empty if it does not. O(1).
    [[nodiscard]] std::optional<BeamRejection> refusal_of(const Beam& beam) const noexcept;
    /// How far it reaches: its range, or how far it may free space without one.
    [[nodiscard]] double length_m(const Beam& beam) const noexcept { return cone_length_m(beam, config_); }
    /// Whether a voxel touches the cap of a beam with a range, as far as a cube and a cap can be told apart
    /// by the cube's centre and half its edge, however long the range.
    [[nodiscard]] bool ends_about(const Beam& beam, VoxelKey key) const noexcept;
    [[nodiscard]] const VoxelLattice& lattice() const noexcept { return lattice_; }
    /// By which they are found, and are to be counted.
    [[nodiscard]] const ConeModel& model_of(const Beam& beam) const noexcept {
        return config_.cone_of(beam.optics);
    }

  private:
    /// Which voxels: how far, how wide, how far off the axis.
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
        double marks_rad = 0.0;  ///< beyond, they have no weight
    };
    void find_passed(const Beam& beam, const Passed& passed);
    void find_cap(const Beam& beam, const Cap& cap);

    MappingConfig config_;
    VoxelLattice lattice_;
    ConeVoxels voxels_;
};

}  // namespace octoskin
