// How thin an object may be to be kept in a map of denoised depth images: a model of `denoised`, without its
// code.
#pragma once

#include <optional>

#include "host/core/depth/depth_denoiser.hpp"

namespace octoskin {

/// A stationary camera and its map. All lengths in metres.
struct ThinView {
    double focal_px = 365.0;  ///< the shorter focal length
    DepthDenoiserConfig denoiser = {};
    double voxel_m = 0.04;
};

/// What of a long object is kept, by its pixels and their noise. It is clear of what is behind it
/// (`standoff_m`).
///
/// At depth z a pixel covers z / focal_px. If the object fills a voxel's length, it has there
/// max(1, thickness / that) * max(1, voxel / that) pixels, of a thickness of at most a voxel. It fills any
/// share of a voxel equally often, and one without a pixel is not seen. The denoiser takes the mean of
/// `images` values of each pixel, and of its neighbours; m of them count here: 5 along the object and up to 5
/// across. It takes more along a straight object, so this is a lower limit. So a pixel's error is
/// sigma / sqrt(images m), and one in five pixels has its own (chosen by measurement: windows overlap). A
/// voxel is kept if one of them ends in it, where the surface is anywhere between its front and its back.
struct ThinKept {
    /// Of the object's length, a pixel falls on this share even in the worst place: 1 from the pixel's size
    /// on.
    double seen = 0.0;
    double of_seen = 0.0;  ///< share of its seen voxels that are kept
};
/// `thickness_m`, `depth_m` (along the optical axis) above 0, `images` at least 1 (asserted). About 50 us.
[[nodiscard]] ThinKept thin_kept(const ThinView& view, double thickness_m, double depth_m, double images);

/// Share of seen voxels from which on an object counts as kept.
inline constexpr double kThinKeptShare = 0.95;

/// The least thickness of an object of which all is seen and kThinKeptShare of it kept, after this number of
/// images. Empty: none that is thinner than a voxel.
[[nodiscard]] std::optional<double> thinnest_kept_m(const ThinView& view, double depth_m, double images);

/// Distance to the surface behind an object of one pixel's width from which on the pixels of that surface do
/// not agree with the object's by chance (`pair_sigmas`), and so do not draw it to them.
[[nodiscard]] double standoff_m(const ThinView& view, double depth_m, double images);

}  // namespace octoskin
