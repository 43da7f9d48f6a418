// How often a voxel that a map calls free is a surface, by the evidence behind it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/core/mapping/free_evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/lab/evaluation/truth.hpp"
#include "host/lab/evaluation/voxel_grid.hpp"

namespace octoskin::evaluation {

/// Free voxels.
struct FreeBin {
    std::uint64_t voxels = 0;
    std::uint64_t surface = 0;  ///< of them surface voxels

    /// Empty without voxels.
    [[nodiscard]] std::optional<double> surface_share() const noexcept;
};

/// Bin i has the voxels with at least i and less than i + 1 measurements; the last one all with more.
inline constexpr std::size_t kFreeBins = 11;
using FreeBins = std::array<FreeBin, kFreeBins>;

/// Bin i has the voxels with at least i measurements: those that a planner's minimum of i leaves free.
[[nodiscard]] FreeBins at_least(const FreeBins& bins) noexcept;

struct FreeCalibration {
    FreeBins images;  ///< by FreeEvidence::images, whatever the beams
    FreeBins beams;   ///< by FreeEvidence::beams, whatever the images
    FreeBins sum;     ///< by FreeEvidence::sum()

    void add(const FreeCalibration& other) noexcept;
};

/// Over the voxels of `surface` that are not interior to a solid. The resolutions must be equal. About 5 ms
/// for the experiment.
[[nodiscard]] FreeCalibration free_calibration(const FusedMap& map, const MissUnits& units,
                                               const VoxelGrid<SurfaceVoxel>& surface);

}  // namespace octoskin::evaluation
