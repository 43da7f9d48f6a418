// How large the cone of one range is, reckoned before any of its voxels is looked at.
#pragma once

#include "host/core/beams/beam.hpp"
#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

/// A range whose cone may have more voxels is refused. To work out one of so many takes some 300 MB and half
/// a second. What a VL53L1X sees, 13.5 degrees and 4 m, has so many with voxels of 4.5 mm.
inline constexpr double kConeVoxelsMax = 1U << 24U;

/// How far a beam reaches: its range, or how far it may free space without one.
[[nodiscard]] double cone_length_m(const Beam& beam, const MappingConfig& config) noexcept;
/// How far before and behind its range a beam's surface may be.
[[nodiscard]] double cap_half_m(const Beam& beam, const MappingConfig& config) noexcept;
/// How far off the axis a beam whose optics are a cone frees space.
[[nodiscard]] double core_angle_rad(const BeamOptics& optics, const MappingConfig& config) noexcept;

/// At most so many voxels ConeFinder looks at for a beam whose optics are a cone, wherever it is and points.
/// O(1), about 50 ns.
[[nodiscard]] double cone_voxels_at_most(const Beam& beam, const MappingConfig& config) noexcept;
/// Whether that may be more than `kConeVoxelsMax`. O(1), a comparison for a beam that is short enough
/// whatever its angles.
[[nodiscard]] bool is_cone_too_large(const Beam& beam, const MappingConfig& config) noexcept;

}  // namespace octoskin
