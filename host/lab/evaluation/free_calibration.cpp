#include "host/lab/evaluation/free_calibration.hpp"

#include <algorithm>

#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin::evaluation {
namespace {

void add_voxel(FreeBins& bins, double measurements, bool is_surface) {
    FreeBin& bin = bins[std::min(static_cast<std::size_t>(measurements), kFreeBins - 1)];
    bin.voxels += 1;
    bin.surface += is_surface ? 1U : 0U;
}

void add_bins(FreeBins& sum, const FreeBins& addend) {
    for (std::size_t i = 0; i < kFreeBins; ++i) {
        sum[i].voxels += addend[i].voxels;
        sum[i].surface += addend[i].surface;
    }
}

}  // namespace

std::optional<double> FreeBin::surface_share() const noexcept {
    if (voxels == 0) return std::nullopt;
    return static_cast<double>(surface) / static_cast<double>(voxels);
}

FreeBins at_least(const FreeBins& bins) noexcept {
    FreeBins sums = bins;
    for (std::size_t i = kFreeBins - 1; i > 0; --i) {
        sums[i - 1].voxels += sums[i].voxels;
        sums[i - 1].surface += sums[i].surface;
    }
    return sums;
}

void FreeCalibration::add(const FreeCalibration& other) noexcept {
    add_bins(images, other.images);
    add_bins(beams, other.beams);
    add_bins(sum, other.sum);
}

FreeCalibration free_calibration(const FusedMap& map, const MissUnits& units,
                                 const VoxelGrid<SurfaceVoxel>& surface) {
    FreeCalibration calibration;
    for (std::size_t i = 0; i < surface.size(); ++i) {
        const VoxelKey key = surface.box().key_at(i);
        if (surface[i].is_interior || map.occupancy(key) != Occupancy::free) continue;
        const FreeEvidence evidence = free_evidence(voxel_state(map.layers(), key), units);
        add_voxel(calibration.images, evidence.images, surface[i].is_surface);
        add_voxel(calibration.beams, evidence.beams, surface[i].is_surface);
        add_voxel(calibration.sum, evidence.sum(), surface[i].is_surface);
    }
    return calibration;
}

}  // namespace octoskin::evaluation
