// Size of the cone of one range, computed before any of its voxels is visited.
#pragma once

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

/// A range whose cone may have more voxels is refused. Computing a cone of this size takes about 300 MB and
/// half a second. The cone of a VL53L1X, 13.5 degrees and 4 m, reaches it with voxels of 4.5 mm.
inline constexpr double kConeVoxelsMax = 1U << 24U;

/// Length of a beam, metres: its range or, without a range, how far it may free space.
[[nodiscard]] double cone_length_m(const Beam& beam, const MappingConfig& config) noexcept;
/// How far before and behind its range a beam's surface may be, metres.
[[nodiscard]] double cap_half_m(const Beam& beam, const MappingConfig& config) noexcept;
/// How far off the axis a beam whose optics are a cone frees space, radians.
[[nodiscard]] double core_angle_rad(const BeamOptics& optics, const MappingConfig& config) noexcept;

/// Upper bound of the voxels that ConeFinder visits for a beam whose optics are a cone, for any position and
/// direction. O(1), about 50 ns.
[[nodiscard]] double cone_voxels_at_most(const Beam& beam, const MappingConfig& config) noexcept;
/// True if that bound may exceed `kConeVoxelsMax`. O(1); a single comparison for a beam that is short enough
/// for every angle.
[[nodiscard]] bool is_cone_too_large(const Beam& beam, const MappingConfig& config) noexcept;

}  // namespace octoskin
